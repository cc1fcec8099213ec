// Times a call over a pool of random states; prints the least time of many short runs as a line of JSON.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

constexpr int POOL = 256, RUNS = 60;

struct Random {
  uint64_t s = 88172645463325252ull;
  double operator()(double size) {
    s ^= s << 13; s ^= s >> 7; s ^= s << 17;
    return size * (2.0 * double(s >> 11) / 9007199254740992.0 - 1.0);
  }
};

template <class F> void time(const std::string& gait, const std::string& what, F call) {
  using clock = std::chrono::steady_clock;
  double best = 1e300;
  for (int run = 0; run < RUNS; run++) {
    auto start = clock::now();
    for (int i = 0; i < 4 * POOL; i++) { call(i % POOL); asm volatile("" ::: "memory"); }
    best = std::min(best, std::chrono::duration<double, std::nano>(clock::now() - start).count() / (4 * POOL));
  }
  printf("{\"gait\":\"%s\",\"what\":\"%s\",\"ns\":%.2f}\n", gait.c_str(), what.c_str(), best);
}
