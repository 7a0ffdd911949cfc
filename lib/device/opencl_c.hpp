// SPDX-License-Identifier: Apache-2.0
// OpenCL C as far as kernels use it, in C++: for the kernels that the host runs by itself, each as one work-item, while
// nobody else has its memory (device/host_kernels.hpp). So atomics are plain, and a barrier is nothing. For generated
// sources only, behind every other header: it takes words such as `local` and `private` away.
#pragma once

#include <cstddef>
#include <cstdint>

static_assert(sizeof(long) == 8, "OpenCL's long has 64 bits");

namespace gcdt::opencl_c {

typedef unsigned char uchar;
typedef unsigned int uint;
typedef unsigned long ulong;

// What a template does not deduce.
template <class T>
struct Same {
  typedef T type;
};
// ---- Vectors: those members and operators that kernels use --------------------------------------
template <class T>
struct alignas(2 * sizeof(T)) Vector2 {
  T x, y;
  Vector2() = default;
  Vector2(T a, T b) : x(a), y(b) {}
  Vector2(const volatile Vector2& read) : x(read.x), y(read.y) {}
  Vector2(const Vector2&) = default;
  Vector2& operator=(const Vector2&) = default;
  Vector2 yx() const { return {y, x}; }
};
template <class T>
struct alignas(4 * sizeof(T)) Vector3 {
  T x, y, z;
  Vector3 yzx() const { return {y, z, x}; }
  Vector3 operator&(T mask) const { return {x & mask, y & mask, z & mask}; }
};
template <class T>
struct alignas(4 * sizeof(T)) Vector4 {
  T x, y, z, w;
  Vector4 yzxw() const { return {y, z, x, w}; }
  Vector4 zxyw() const { return {z, x, y, w}; }
  Vector3<T> xyz() const { return {x, y, z}; }
  Vector2<T> xy() const { return {x, y}; }
  Vector2<T> zw() const { return {z, w}; }
  Vector4 operator+(Vector4 v) const { return {x + v.x, y + v.y, z + v.z, w + v.w}; }
  Vector4& operator+=(Vector4 v) { return *this = *this + v; }
  Vector4 operator^(T bits) const { return {x ^ bits, y ^ bits, z ^ bits, w ^ bits}; }
};
typedef Vector2<int> int2;
typedef Vector2<uint> uint2;
typedef Vector2<long> long2;
typedef Vector2<ulong> ulong2;
typedef Vector3<int> int3;
typedef Vector3<uint> uint3;
typedef Vector4<int> int4;
typedef Vector4<uint> uint4;

// A literal (uint2)(x, y) of OpenCL C, which kernels/host.cmake renames.
inline int2 make_int2(int x, int y) { return {x, y}; }
inline uint2 make_uint2(uint x, uint y) { return {x, y}; }
inline long2 make_long2(long x, long y) { return {x, y}; }
inline ulong2 make_ulong2(ulong x, ulong y) { return {x, y}; }
inline ulong2 make_ulong2(ulong x) { return {x, x}; }
inline int3 make_int3(int x, int y, int z) { return {x, y, z}; }
inline uint3 make_uint3(uint x, uint y, uint z) { return {x, y, z}; }
inline int4 make_int4(int x, int y, int z, int w) { return {x, y, z, w}; }
inline uint4 make_uint4(uint x, uint y, uint z, uint w) { return {x, y, z, w}; }
inline int4 make_int4(int2 xy, int2 zw) { return {xy.x, xy.y, zw.x, zw.y}; }
inline uint4 make_uint4(uint x) { return {x, x, x, x}; }

template <class T>
Vector3<T> vload3(std::size_t i, const T* from) {
  return {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
}
template <class T>
void vstore3(Vector3<T> v, std::size_t i, T* to) {
  to[3 * i] = v.x, to[3 * i + 1] = v.y, to[3 * i + 2] = v.z;
}

// By the highest bit of each component of c: b's or a's.
inline uint4 select(uint4 a, uint4 b, uint4 c) {
  const auto of = [](uint x, uint y, uint bits) { return bits >> 31 ? y : x; };
  return {of(a.x, b.x, c.x), of(a.y, b.y, c.y), of(a.z, b.z, c.z), of(a.w, b.w, c.w)};
}

// ---- Integers -----------------------------------------------------------------------------------
inline int min(int a, int b) { return a < b ? a : b; }
inline int max(int a, int b) { return a > b ? a : b; }
inline uint min(uint a, uint b) { return a < b ? a : b; }
inline uint max(uint a, uint b) { return a > b ? a : b; }
inline long min(long a, long b) { return a < b ? a : b; }
inline long max(long a, long b) { return a > b ? a : b; }
inline ulong min(ulong a, ulong b) { return a < b ? a : b; }
inline ulong max(ulong a, ulong b) { return a > b ? a : b; }
inline uint clz(uint x) { return x == 0 ? 32u : static_cast<uint>(__builtin_clz(x)); }
inline ulong clz(ulong x) { return x == 0 ? 64u : static_cast<ulong>(__builtin_clzl(x)); }
inline uint popcount(uint x) { return static_cast<uint>(__builtin_popcount(x)); }
inline ulong popcount(ulong x) { return static_cast<ulong>(__builtin_popcountl(x)); }
inline uint abs(int x) { return x < 0 ? 0u - static_cast<uint>(x) : static_cast<uint>(x); }
inline ulong abs(long x) { return x < 0 ? 0ul - static_cast<ulong>(x) : static_cast<ulong>(x); }
inline uint abs_diff(int x, int y) {
  return x < y ? static_cast<uint>(y) - static_cast<uint>(x) : static_cast<uint>(x) - static_cast<uint>(y);
}
inline uint abs_diff(uint x, uint y) { return x < y ? y - x : x - y; }
inline ulong abs_diff(long x, long y) {
  return x < y ? static_cast<ulong>(y) - static_cast<ulong>(x) : static_cast<ulong>(x) - static_cast<ulong>(y);
}
template <class T>
T clamp(T x, typename Same<T>::type least, typename Same<T>::type most) {
  return x < least ? least : most < x ? most : x;
}
inline ulong mul_hi(ulong a, ulong b) {
  __extension__ typedef unsigned __int128 Wide;
  return static_cast<ulong>(static_cast<Wide>(a) * b >> 64);
}

// ---- Atomics: each returns what was there -------------------------------------------------------
template <class T, class F>
T changed(volatile T* at, F&& value_of) {
  const T was = *at;
  *at = value_of(was);
  return was;
}
template <class T>
T atomic_add(volatile T* at, typename Same<T>::type value) {
  return changed(at, [&](T was) { return was + value; });
}
template <class T>
T atomic_and(volatile T* at, typename Same<T>::type value) {
  return changed(at, [&](T was) { return was & value; });
}
template <class T>
T atomic_or(volatile T* at, typename Same<T>::type value) {
  return changed(at, [&](T was) { return was | value; });
}
template <class T>
T atomic_min(volatile T* at, typename Same<T>::type value) {
  return changed(at, [&](T was) { return was < value ? was : value; });
}
template <class T>
T atomic_max(volatile T* at, typename Same<T>::type value) {
  return changed(at, [&](T was) { return was > value ? was : value; });
}
template <class T>
T atomic_xchg(volatile T* at, typename Same<T>::type value) {
  return changed(at, [&](T) { return value; });
}
template <class T>
T atomic_cmpxchg(volatile T* at, typename Same<T>::type expected, typename Same<T>::type value) {
  return changed(at, [&](T was) { return was == expected ? value : was; });
}
template <class T>
T atomic_inc(volatile T* at) {
  return atomic_add(at, 1);
}

// ---- The only work-item -------------------------------------------------------------------------
inline std::size_t get_global_id(uint) { return 0; }
inline std::size_t get_group_id(uint) { return 0; }
inline std::size_t get_local_id(uint) { return 0; }
inline std::size_t get_global_size(uint) { return 1; }
inline std::size_t get_num_groups(uint) { return 1; }
inline std::size_t get_local_size(uint) { return 1; }
enum { CLK_LOCAL_MEM_FENCE = 1, CLK_GLOBAL_MEM_FENCE = 2 };
inline void barrier(int) {}

}  // namespace gcdt::opencl_c

#define __OPENCL_VERSION__ 120
#define GCDT_CONTIGUOUS
#define GCDT_ALONE  // the launch has no other work-item
#define kernel static
#define global
#define local
#define private
#define constant const
