// SPDX-License-Identifier: Apache-2.0
#include "zip_archive.hpp"

#include <zip.h>
#include <zlib.h>

#include <filesystem>

namespace gcdt::io {

namespace {

/// Deflate makes of a byte at most so many: an entry that announces more is none.
constexpr std::uint64_t most_a_byte = 1032;

std::string said(zip_error_t* error) { return zip_error_strerror(error); }

zip* opened(const std::string& path) {
  int code = 0;
  if (zip* archive = zip_open(path.c_str(), ZIP_RDONLY, &code)) return archive;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string why = said(&error);
  zip_error_fini(&error);
  throw Failure(Exit::input, fmt::format("{}: cannot be opened as an archive (.npz): {}", path, why));
}

}  // namespace

ZipArchive::ZipArchive(const std::string& path) : path_(path), archive_(nullptr, zip_discard) {
  if (std::filesystem::is_directory(path))
    throw Failure(Exit::input, fmt::format("{}: cannot be read: is a directory", path));
  archive_.reset(opened(path));
}

bool ZipArchive::has(const std::string& entry) const { return zip_name_locate(archive_.get(), entry.c_str(), 0) >= 0; }

ByteSource ZipArchive::open(const std::string& entry) const {
  const std::string name = fmt::format("{}: {}", path_, entry);
  zip_stat_t stat;
  const bool known = zip_stat(archive_.get(), entry.c_str(), 0, &stat) == 0 && (stat.valid & ZIP_STAT_SIZE) != 0 &&
                     (stat.valid & ZIP_STAT_COMP_SIZE) != 0;
  zip_file_t* file = known ? zip_fopen(archive_.get(), entry.c_str(), 0) : nullptr;
  if (!file) throw Failure(Exit::input, fmt::format("{}: {}", name, said(zip_get_error(archive_.get()))));
  const std::shared_ptr<zip_file_t> held(file, zip_fclose);
  std::error_code ignored;
  if (stat.comp_size > std::filesystem::file_size(path_, ignored) || stat.size / most_a_byte > stat.comp_size)
    throw Failure(Exit::input, fmt::format("{}: more bytes are announced than the file can hold", name));
  const auto some = [name, held](char* to, std::uint64_t bytes) {
    const zip_int64_t got = zip_fread(held.get(), to, bytes);
    if (got < 0) throw Failure(Exit::input, fmt::format("{}: {}", name, said(zip_file_get_error(held.get()))));
    return static_cast<std::uint64_t>(got);
  };
  std::uint64_t left = stat.size;
  return {name, stat.size, [=](void* to, std::uint64_t bytes) mutable {
            std::uint64_t done = 0;
            while (done < bytes) {
              const std::uint64_t got = some(static_cast<char*>(to) + done, bytes - done);
              if (got == 0) break;
              done += got;
            }
            left -= done;
            char beyond;
            if (left == 0) some(&beyond, 1);  // only at its end libzip compares the sum
            return done;
          }};
}

namespace {

// Of the format (PKWARE's APPNOTE, 4.3): signatures, and what marks a number that stands in a field of 64 bits.
constexpr std::uint64_t local_header = 0x04034b50, directory_header = 0x02014b50, directory_end = 0x06054b50;
constexpr std::uint64_t long_directory_end = 0x06064b50, long_end_locator = 0x07064b50;
constexpr std::uint64_t elsewhere = 0xffffffff, elsewhere_16 = 0xffff;
constexpr std::uint64_t version = 45, long_field = 1;
constexpr std::uint64_t first_date = 0x21;  // 1 January 1980, the first that there is

}  // namespace

void ZipWriter::put(std::initializer_list<std::pair<std::uint64_t, int>> fields) {
  for (auto [number, bytes] : fields)
    for (int i = 0; i < bytes; ++i, ++at_) {
      const char byte = static_cast<char>(number >> 8 * i & 255);
      file_.write({&byte, 1});
    }
}

void ZipWriter::add(const std::string& name, const std::function<void(const Sink&)>& write) {
  Entry entry{name, 0, 0, at_};
  uLong sum = crc32(0, nullptr, 0);
  write([&](std::string_view bytes) {
    sum = crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    entry.size += bytes.size();
  });
  entry.sum = static_cast<std::uint32_t>(sum);
  put({{local_header, 4}, {version, 2}, {0, 2}, {0, 2}, {0, 2}, {first_date, 2}, {entry.sum, 4}});
  put({{elsewhere, 4}, {elsewhere, 4}, {name.size(), 2}, {20, 2}});
  file_.write(name);
  at_ += name.size();
  put({{long_field, 2}, {16, 2}, {entry.size, 8}, {entry.size, 8}});
  write([&](std::string_view bytes) { file_.write(bytes); });
  at_ += entry.size;
  entries_.push_back(std::move(entry));
}

void ZipWriter::finish() {
  const std::uint64_t begin = at_;
  for (const Entry& entry : entries_) {
    put({{directory_header, 4}, {version, 2}, {version, 2}, {0, 2}, {0, 2}, {0, 2}, {first_date, 2}, {entry.sum, 4}});
    put({{elsewhere, 4}, {elsewhere, 4}, {entry.name.size(), 2}, {28, 2}, {0, 2}, {0, 2}, {0, 2}, {0, 4}});
    put({{elsewhere, 4}});
    file_.write(entry.name);
    at_ += entry.name.size();
    put({{long_field, 2}, {24, 2}, {entry.size, 8}, {entry.size, 8}, {entry.offset, 8}});
  }
  const std::uint64_t end = at_, count = entries_.size();
  put({{long_directory_end, 4}, {44, 8}, {version, 2}, {version, 2}, {0, 4}, {0, 4}, {count, 8}, {count, 8}});
  put({{end - begin, 8}, {begin, 8}});
  put({{long_end_locator, 4}, {0, 4}, {end, 8}, {1, 4}});
  put({{directory_end, 4},
       {0, 2},
       {0, 2},
       {elsewhere_16, 2},
       {elsewhere_16, 2},
       {elsewhere, 4},
       {elsewhere, 4},
       {0, 2}});
}

}  // namespace gcdt::io
