#include "timing.hpp"

struct Function {
  int (*call)(const double**, double**, long long*, double*, int);
  const char *gait, *what;
  int inputs, sizes[4], outputs, results[4], work;
};
#include "casadi_list.hpp"

int main() {
  for (const Function& f : FUNCTIONS) {
    Random random;
    std::vector<std::vector<double>> in(f.inputs), out(f.outputs);
    for (int k = 0; k < f.inputs; k++) {
      in[k].resize(size_t(POOL) * f.sizes[k]);
      for (double& x : in[k]) x = random(k == 2 ? 60.0 : k == 1 ? 5.0 : 1.2);
    }
    std::vector<double> work(f.work + 1);
    std::vector<double*> results;
    for (int k = 0; k < f.outputs; k++) { out[k].resize(f.results[k]); results.push_back(out[k].data()); }
    std::vector<const double*> arguments(f.inputs);
    time(f.gait, f.what, [&](int i) {
      for (int k = 0; k < f.inputs; k++) arguments[k] = in[k].data() + size_t(i) * f.sizes[k];
      f.call(arguments.data(), results.data(), nullptr, work.data(), 0);
    });
  }
}
