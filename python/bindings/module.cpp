// SPDX-License-Identifier: Apache-2.0
// The extension gcdt._gcdt. What users call is python/gcdt/*.py, over it.
#include "options.hpp"

NB_MODULE(_gcdt, m) {
  using namespace gcdt::python;
  nb::set_leak_warnings(false);  // objects may outlive the interpreter's clean-up, which is no leak
  bind_errors();
  bind_options(m);
  bind_solver(m);
  bind_proof(m);
  bind_pool(m);
  bind_device_memory(m);
}
