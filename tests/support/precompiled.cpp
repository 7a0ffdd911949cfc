// SPDX-License-Identifier: Apache-2.0
// The target that owns the precompiled header has to have a source.
#include "precompiled.hpp"
