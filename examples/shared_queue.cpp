// SPDX-License-Identifier: Apache-2.0
// An application with an OpenCL context of its own: a kernel of its own makes the points, gcdt triangulates them, and
// the next kernel works on the triangles where they are. No point and no triangle passes through host memory.
#include <cstdio>

#include <gcdt/gcdt_cl.hpp>

namespace {

const char* const kernels = R"(
// A lattice of side * side points, every second row shifted.
kernel void make_points(int side, global int2* points) {
  int i = get_global_id(0);
  points[i] = (int2)(20 * (i % side) + (i / side % 2) * 10, 17 * (i / side));
}
// Twice the area of each triangle.
kernel void areas(global const int2* points, global const uint* triangles, global long* twice) {
  uint t = get_global_id(0);
  uint3 c = vload3(t, triangles);
  long2 a = convert_long2(points[c.y] - points[c.x]), b = convert_long2(points[c.z] - points[c.x]);
  twice[t] = a.x * b.y - a.y * b.x;
}
)";

int run() {
  const int side = 100, count = side * side;
  const cl::Device device = cl::Device::getDefault();
  const cl::Context context(device);
  const cl::CommandQueue queue(context, device);
  cl::Program program(context, kernels);
  if (program.build({device}) != CL_SUCCESS) return 1;

  const cl::Buffer points(context, CL_MEM_READ_WRITE, sizeof(cl_int2) * count);
  cl::Kernel make_points(program, "make_points");
  make_points.setArg(0, side);
  make_points.setArg(1, points);
  queue.enqueueNDRangeKernel(make_points, cl::NullRange, cl::NDRange(count));

  gcdt::Solver solver = gcdt::make_solver(queue);
  const gcdt::Result mesh = gcdt::solve(solver, {gcdt::Points::Type::int32, points, std::uint64_t(count)});
  const std::size_t triangles = mesh.triangle_count();

  const cl::Buffer twice(context, CL_MEM_READ_WRITE, sizeof(cl_long) * triangles);
  cl::Kernel areas(program, "areas");
  areas.setArg(0, points);
  areas.setArg(1, gcdt::buffer_of(mesh, GCDT_TRIANGLES));
  areas.setArg(2, twice);
  queue.enqueueNDRangeKernel(areas, cl::NullRange, cl::NDRange(triangles));
  std::vector<cl_long> found(triangles);
  queue.enqueueReadBuffer(twice, CL_TRUE, 0, sizeof(cl_long) * triangles, found.data());

  cl_long total = 0;
  for (cl_long area : found) {
    if (area <= 0) return 1;
    total += area;
  }
  std::printf("%d points, %zu triangles, twice the area is %lld\n", count, triangles, static_cast<long long>(total));
  // The hull: from (0, 0) to (20 (side - 1) + 10, 17 (side - 1)), less a corner of 10 by 17 at each end.
  const cl_long width = 20 * (side - 1) + 10, height = 17 * (side - 1);
  return total == 2 * width * height - 2 * 10 * 17 ? 0 : 1;
}

}  // namespace

int main() try { return run(); } catch (const gcdt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
