#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
cmake -S . -B build && cmake --build build
build/tools/gcdt devices
build/tools/gcdt triangulate examples/data/countries-50m.poly --verify -o countries.svg -o countries.vtu
