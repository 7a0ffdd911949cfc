// SPDX-License-Identifier: Apache-2.0
// Deterministic inputs: everything but the letters. Compiled without contraction to fused multiply-add.
#include "workloads.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

namespace gcdt::test {

Point direction(std::uint32_t turn) {
  static const auto rotations = [] {  // of 2^31, 2^30, ..., 2^0: each half the angle of the one before
    std::vector<Point> r{{-1, 0}, {0, 1}};
    while (r.size() < 32) {
      const double c = std::sqrt((1 + r.back()[0]) / 2);
      r.push_back({c, r.back()[1] / (2 * c)});
    }
    return r;
  }();
  Point p{1, 0};
  for (int bit = 31; bit >= 0; --bit) {
    if (!(turn >> bit & 1)) continue;
    const Point& r = rotations[31 - bit];
    p = {p[0] * r[0] - p[1] * r[1], p[0] * r[1] + p[1] * r[0]};
  }
  return p;
}

Workload shuffled_vertices(const Workload& work, Random& random) {
  std::vector<std::uint32_t> position(work.points.size());
  std::iota(position.begin(), position.end(), 0u);
  shuffle(position, random);
  Workload result;
  result.points.resize(work.points.size());
  for (std::size_t i = 0; i < position.size(); ++i) result.points[position[i]] = work.points[i];
  for (const Segment& s : work.constraints) result.constraints.push_back({position[s[0]], position[s[1]]});
  return result;
}

double snapped(double value) { return std::floor(value * 0x1p29 + 0.5) * 0x1p-29; }

namespace {

std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

Point snapped(const Point& p) { return {test::snapped(p[0]), test::snapped(p[1])}; }

/// `i` of `n` equal steps around.
Point step(std::size_t i, std::size_t n) {
  return direction(static_cast<std::uint32_t>((static_cast<std::uint64_t>(i) << 32) / n));
}

std::vector<Segment> closed(std::size_t first, std::size_t count) {
  std::vector<Segment> s;
  for (std::size_t i = 0; i < count; ++i) s.push_back({index(first + i), index(first + (i + 1) % count)});
  return s;
}

/// Exact below 2^31: the products stay below 2^64 in size.
int orientation(const Point& a, const Point& b, const Point& c) {
  const auto x = [](double v) { return static_cast<__int128>(v); };
  const __int128 d = (x(b[0]) - x(a[0])) * (x(c[1]) - x(a[1])) - (x(b[1]) - x(a[1])) * (x(c[0]) - x(a[0]));
  return (d > 0) - (d < 0);
}

}  // namespace

Workload uniform(std::size_t n, std::uint64_t seed) {
  Random random(1000 + seed);
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = random.unit();
    work.points.push_back({x, random.unit()});
  }
  return work;
}

Workload gaussian(std::size_t n) {
  Random random(2000);
  const auto bell = [&] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += random.unit();
    return 0.5 + 0.1 * sum;
  };
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = bell();
    work.points.push_back({x, bell()});
  }
  return work;
}

Workload ring(std::size_t n) {
  Random random(3000);
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::sqrt(random.between(0.45 * 0.45, 0.46 * 0.46));
    const Point d = direction(static_cast<std::uint32_t>(random.next() >> 32));
    work.points.push_back({0.5 + r * d[0], 0.5 + r * d[1]});
  }
  return work;
}

Workload clusters(std::size_t n) {
  Random random(3500);
  std::vector<Point> centres(50);
  for (Point& c : centres) c = {random.between(0.2, 0.8), random.between(0.2, 0.8)};
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t circle = i % centres.size();
    const double radius = 1 / static_cast<double>(std::uint64_t{8} << (3 * (circle % 9)));
    const Point d = direction(static_cast<std::uint32_t>(random.next() >> 32));
    work.points.push_back({centres[circle][0] + radius * d[0], centres[circle][1] + radius * d[1]});
  }
  return work;
}

Workload grid(std::size_t n) {
  std::size_t side = 0;
  while ((side + 1) * (side + 1) <= n) ++side;
  Workload work;
  for (std::size_t i = 0; i < side * side; ++i)
    work.points.push_back({static_cast<double>(i % side), static_cast<double>(i / side)});
  Random random(4000 + side);
  shuffle(work.points, random);
  return work;
}

Workload lattice_circle(std::size_t n) {
  using Complex = std::array<std::int64_t, 2>;
  const auto times = [](Complex a, Complex b) { return Complex{a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]}; };
  struct Prime {  // p = a^2 + b^2 = (a + ib)(a - ib); every choice of factors gives a point of the same norm
    Complex factor;
    int exponent;
  };
  const Prime primes[] = {{{2, 1}, 3}, {{3, 2}, 2}, {{4, 1}, 1}, {{5, 2}, 1}, {{6, 1}, 1},
                          {{5, 4}, 1}, {{7, 2}, 1}, {{6, 5}, 1}, {{8, 3}, 1}, {{8, 5}, 1}};
  std::set<Complex> circle{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (const Prime& prime : primes) {
    std::set<Complex> next;
    for (int conjugated = 0; conjugated <= prime.exponent; ++conjugated) {
      Complex product{1, 0};
      for (int i = 0; i < prime.exponent; ++i)
        product = times(product, {prime.factor[0], i < conjugated ? -prime.factor[1] : prime.factor[1]});
      for (const Complex& z : circle) next.insert(times(z, product));
    }
    circle = std::move(next);
  }
  Workload work;
  for (const Complex& z : circle)
    work.points.push_back({static_cast<double>(z[0]) + 0x1p30, static_cast<double>(z[1]) + 0x1p30});
  Random random(5003);
  shuffle(work.points, random);
  if (work.points.size() > n) work.points.resize(n);
  return work;
}

Workload near_circle(std::size_t n) {
  Workload work;
  for (std::size_t i = 0; i < n; ++i) work.points.push_back(step(i, n));
  Random random(5004);
  shuffle(work.points, random);
  return work;
}

Workload collinear_runs(std::size_t n) {
  const double directions[8][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {-1, 2}, {3, -2}, {-5, -7}};
  const std::size_t length = std::max<std::size_t>(n / 8, 2);
  Workload work;
  Random random(5005);
  for (std::size_t run = 0; run < 8; ++run) {  // each in a cell of its own, so that no two meet
    const double cell = 16.0 * static_cast<double>(length);
    const Point centre{cell * static_cast<double>(run % 4), cell * static_cast<double>(run / 4)};
    std::vector<std::size_t> order(length);
    std::iota(order.begin(), order.end(), 0);
    shuffle(order, random);
    const std::size_t base = work.points.size();
    Segment ends{};
    for (std::size_t k = 0; k < length; ++k) {
      if (order[k] == 0) ends[0] = index(base + k);
      if (order[k] == length - 1) ends[1] = index(base + k);
      const double t = static_cast<double>(order[k]);
      work.points.push_back({centre[0] + t * directions[run][0], centre[1] + t * directions[run][1]});
    }
    work.constraints.push_back(ends);
  }
  return work;
}

Workload line(std::size_t n) {
  Workload work;
  for (std::size_t i = 0; i < n; ++i) work.points.push_back({static_cast<double>(i), 3.0 * static_cast<double>(i)});
  Random random(5006);
  shuffle(work.points, random);
  for (std::size_t i = 0; i < n / 4; ++i) {
    const std::uint32_t a = index(random.below(n));
    work.constraints.push_back({a, index(random.below(n))});
  }
  return work;
}

Workload comb(std::size_t n) {
  const std::size_t teeth = std::max<std::size_t>((n - 2) / 4, 1);
  Workload work;
  for (std::size_t i = 0; i < teeth; ++i) {
    const double x = 2 * static_cast<double>(i);
    work.points.insert(work.points.end(), {{x, 0}, {x, 1000}, {x + 1, 1000}, {x + 1, 0}});
  }
  work.points.push_back({2 * static_cast<double>(teeth) - 1, -10});
  work.points.push_back({0, -10});
  work.constraints = closed(0, work.points.size());
  return work;
}

Workload spiral(std::size_t n) {
  const std::size_t half = n / 2, turns = std::max<std::size_t>(half / 833, 3);
  const double pitch = 0.5 / static_cast<double>(turns);
  Workload work;
  const auto wall = [&](std::size_t i, double offset) {  // from one whole turn to the last
    const double t = 1 + static_cast<double>(i) / static_cast<double>(half - 1) * static_cast<double>(turns - 1);
    const double r = t * pitch + offset, whole = std::floor(t);
    const Point d = direction(static_cast<std::uint32_t>((t - whole) * 0x1p32));
    work.points.push_back(snapped({0.5 + r * d[0], 0.5 + r * d[1]}));
  };
  for (std::size_t i = 0; i < half; ++i) wall(i, 0);
  for (std::size_t i = half; i-- > 0;) wall(i, pitch / 2);
  work.constraints = closed(0, work.points.size());
  return work;
}

Workload star(std::size_t n) {
  Workload work = uniform(n - 2, 5001);
  work.points.push_back({0, 0.5});
  work.points.push_back({1, 0.5001});
  work.constraints = {{index(n - 2), index(n - 1)}};
  return work;
}

Workload fan(std::size_t n) {
  const std::size_t count = std::min<std::size_t>(std::max<std::size_t>(n / 200, 1), 1000);
  Workload work = uniform(n - 2 * count, 5002);
  for (Point& p : work.points) p = snapped(p);
  const std::size_t first = work.points.size();
  Random random(5002);
  for (double x : {0.0, 1.0}) {  // sorted ends on both sides: a narrow band on the left, a wide one on the right
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (static_cast<double>(i) + 0.5 * random.unit()) / static_cast<double>(count);
      work.points.push_back(snapped({x, x == 0 ? 0.49 + 0.02 * share : 0.4 + 0.2 * share}));
    }
  }
  for (std::size_t i = 0; i < count; ++i) work.constraints.push_back({index(first + i), index(first + count + i)});
  shuffle(work.constraints, random);
  return work;
}

Workload nested_squares(std::size_t n) {
  Workload work;
  for (std::size_t i = 1; i <= n / 4; ++i) {
    const double r = static_cast<double>(i);
    const std::size_t first = work.points.size();
    work.points.insert(work.points.end(), {{-r, -r}, {r, -r}, {r, r}, {-r, r}});
    for (const Segment& s : closed(first, 4)) work.constraints.push_back(s);
  }
  return work;
}

Workload hub(std::size_t n) {
  Random random(5007);
  const auto coordinate = [&] { return static_cast<std::int64_t>(random.below(1 << 21)) - (1 << 20); };
  std::set<std::array<std::int64_t, 2>> directions;  // primitive ones: no spoke runs through another's end
  while (directions.size() < n / 2) {
    const std::int64_t x = coordinate(), y = coordinate(), divisor = std::gcd(x, y);
    if (divisor != 0) directions.insert({x / divisor, y / divisor});
  }
  Workload work{{{0, 0}}, {}};
  for (const auto& d : directions) {
    work.constraints.push_back({0, index(work.points.size())});
    work.points.push_back({static_cast<double>(d[0]), static_cast<double>(d[1])});
  }
  while (work.points.size() < n) {
    const double x = static_cast<double>(coordinate());
    work.points.push_back({x, static_cast<double>(coordinate())});
  }
  return work;
}

Workload two_clusters(std::size_t n) {
  Random random(5008);
  const double far = 2147483647;
  std::uint64_t side = 2000;
  while (side * side < 16 * n) side *= 2;
  Workload work;
  for (std::size_t i = 0; i + 200 < n; ++i) {
    const double x = static_cast<double>(random.below(side)), y = static_cast<double>(random.below(side));
    work.points.push_back(i % 2 ? Point{x, y} : Point{far - x, far - y});
  }
  for (std::size_t i = 0; i < 100; ++i) {  // sorted ends, beside the clusters
    const double y = static_cast<double>(side / 100 * i), x = static_cast<double>(side);
    work.constraints.push_back({index(work.points.size()), index(work.points.size() + 1)});
    work.points.push_back({x, y});
    work.points.push_back({far - x, far - static_cast<double>(side) + y});
  }
  shuffle(work.constraints, random);
  return work;
}

bool cross(const std::vector<Point>& points, const Segment& s, const Segment& t) {
  const auto side = [&](const Segment& of, const Point& p) { return orientation(points[of[0]], points[of[1]], p); };
  if (side(s, points[t[0]]) * side(s, points[t[1]]) >= 0 || side(t, points[s[0]]) * side(t, points[s[1]]) >= 0)
    return false;
  return std::none_of(points.begin(), points.end(), [&](const Point& p) { return side(s, p) == 0 && side(t, p) == 0; });
}

Workload random_crossing(std::size_t n, std::uint32_t side, std::size_t m, std::uint64_t seed) {
  Random random(seed * 0x100000001b3u + side);
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(random.below(side));
    work.points.push_back({x, static_cast<double>(random.below(side))});
  }
  for (std::size_t i = 0; i < m; ++i) {
    const std::uint32_t a = index(random.below(n));
    work.constraints.push_back({a, index(random.below(n))});
  }
  return work;
}

Workload random_pslg(std::size_t n, std::uint32_t side, std::size_t m, std::uint64_t seed) {
  Workload work = random_crossing(n, side, m, seed);
  std::vector<Segment> kept;
  for (const Segment& s : work.constraints)
    if (std::none_of(kept.begin(), kept.end(), [&](const Segment& t) { return cross(work.points, s, t); }))
      kept.push_back(s);
  work.constraints = kept;
  return work;
}

namespace {

struct Generator {
  const char* name;
  Workload (*make)(std::size_t);
};
const Generator generators[] = {
    {"uniform", [](std::size_t n) { return uniform(n); }},
    {"gaussian", gaussian},
    {"ring", ring},
    {"clusters", clusters},
    {"grid", grid},
    {"lattice_circle", lattice_circle},
    {"near_circle", near_circle},
    {"collinear_runs", collinear_runs},
    {"line", line},
    {"line_and_one", line_and_one},
    {"comb", comb},
    {"spiral", spiral},
    {"star", star},
    {"fan", fan},
    {"nested_squares", nested_squares},
    {"hub", hub},
    {"two_clusters", two_clusters},
    {"parabola", parabola},
    {"letters", [](std::size_t n) { return letters(n); }},
    {"letters_2", [](std::size_t n) { return letters(n, 16004); }},
    {"letters_3", [](std::size_t n) { return letters(n, 16005); }},
    {"letters_4", [](std::size_t n) { return letters(n, 16006); }},
    {"letters_5", [](std::size_t n) { return letters(n, 16007); }},
    {"row", row},
    {"row_between", row_between},
    {"two_rows", two_rows},
    {"closed_comb", closed_comb},
    {"dense_border", dense_border},
    {"sunray", sunray},
    {"log_spirals", log_spirals},
    {"random_pslg", [](std::size_t n) { return random_pslg(n, index(n / 4 + 3), 3 * n, 7); }},
};

}  // namespace

Workload workload(const std::string& name, std::size_t n) {
  for (const Generator& generator : generators)
    if (name == generator.name) return generator.make(n);
  throw std::invalid_argument("no workload is called " + name);
}

std::vector<std::string> workload_names() {
  std::vector<std::string> names;
  for (const Generator& generator : generators) names.push_back(generator.name);
  return names;
}

}  // namespace gcdt::test
