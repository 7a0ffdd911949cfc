// SPDX-License-Identifier: Apache-2.0
// What uploads bring to the device, whatever the host memory is and however the pieces fall into chunks.
#include <doctest/doctest.h>

#include <random>

#include "device/upload.hpp"
#include "opencl_app.hpp"
#include "random_bytes.hpp"

using namespace gcdt;
using namespace gcdt::runtime;
using namespace gcdt::test;

namespace {

/// A runtime whose uploads go through memory of the driver's own, unless calls of that name for it fail.
Runtime mapping_runtime(const char* refused = nullptr) {
  CallHook hook;
  hook.tuning.prepares_host_memory = true;
  hook.before = [refused](const char* call, const char* detail) -> cl_int {
    const bool refuse = refused && std::string(detail) == "host memory" && std::string(call) == refused;
    return refuse ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
  };
  return Runtime(app_device(), hook);
}

/// Uploads of several lengths one right after the other, in pieces of all sizes; then what each brought.
void check_uploads(Runtime& runtime) {
  TransferChunks chunks = upload_chunks(runtime);
  const std::size_t chunk = chunks.chunk_bytes();
  const std::size_t lengths[] = {1, chunk - 1, chunk, chunk + 1, 3 * chunk, 7 * chunk / 2 + 3, 5};
  std::vector<std::vector<unsigned char>> given;
  std::vector<Buffer<cl_uchar>> buffers;
  for (const std::size_t length : lengths) {
    given.push_back(random_bytes(length, static_cast<unsigned>(given.size())));
    buffers.push_back(runtime.allocate<cl_uchar>("uploaded", length));
    Upload upload(chunks, buffers.back().handle());
    std::mt19937 random(7);
    std::vector<unsigned char> piece;  // gone when the upload is under way
    for (std::size_t at = 0; at < length;) {
      const std::size_t next = std::min<std::size_t>(length - at, random() % (chunk / 3));
      piece.assign(given.back().begin() + at, given.back().begin() + at + next);
      upload.append(piece.data(), next);
      at += next;
    }
    upload.send();
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    CAPTURE(lengths[i]);
    std::vector<unsigned char> found(lengths[i]);
    runtime.read(buffers[i], found.data(), found.size());
    const bool same = found == given[i];
    CHECK(same);
  }
}

}  // namespace

TEST_CASE("uploads bring every byte to its place") {
  SUBCASE("as the device has it") {
    Runtime runtime(app_device());
    check_uploads(runtime);
  }
  SUBCASE("through memory of the driver's own") {
    Runtime runtime = mapping_runtime();
    check_uploads(runtime);
  }
  SUBCASE("which the driver has none of") {
    for (const char* refused : {"clCreateBuffer", "clEnqueueMapBuffer"}) {
      Runtime runtime = mapping_runtime(refused);
      check_uploads(runtime);
    }
  }
}

TEST_CASE("elements are not cut in two where a chunk ends") {
  Runtime runtime = mapping_runtime();
  TransferChunks chunks = upload_chunks(runtime);
  struct Element {
    cl_uint words[3];
  };
  const std::size_t count = chunks.chunk_bytes() / sizeof(Element) * 3 + 5;
  const auto buffer = runtime.allocate<Element>("elements", count);
  Upload upload(chunks, buffer.handle());
  cl_uint number = 0;
  for (std::size_t left = count; left > 0;) {
    const auto [to, room] = upload.room<Element>(left);
    REQUIRE(room > 0);
    REQUIRE(room <= left);
    for (std::size_t i = 0; i < room; ++i, ++number) to[i] = {{number, ~number, number * 3}};
    left -= room;
  }
  upload.send();
  std::vector<Element> found(count);
  runtime.read(buffer, found.data(), count);
  bool right = true;
  for (cl_uint i = 0; i < count; ++i)
    right = right && found[i].words[0] == i && found[i].words[1] == ~i && found[i].words[2] == i * 3;
  CHECK(right);
}
