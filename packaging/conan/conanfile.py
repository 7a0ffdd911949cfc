# SPDX-License-Identifier: Apache-2.0
"""The library for Conan 2: `conan create packaging/conan` in a checkout. OpenCL is the system's."""
import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class Gcdt(ConanFile):
    name = "gcdt"
    description = "Exact constrained Delaunay triangulation on OpenCL devices"
    license = "Apache-2.0"
    topics = ("delaunay", "triangulation", "mesh", "opencl")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False]}
    default_options = {"shared": False, "fPIC": True}
    implements = ["auto_shared_fpic"]

    @property
    def _checkout(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        text = load(self, os.path.join(self._checkout, "CMakeLists.txt"))
        self.version = re.search(r"project\(gcdt VERSION ([0-9.]+)", text).group(1)

    def export_sources(self):
        for name in ("CMakeLists.txt", "LICENSE", "packaging/packages.cmake"):
            copy(self, name, self._checkout, self.export_sources_folder)
        for folder in ("include", "kernels", "lib"):
            copy(self, f"{folder}/*", self._checkout, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def system_requirements(self):
        from conan.tools.system.package_manager import Apt

        Apt(self).install(["ocl-icd-opencl-dev", "opencl-c-headers"], check=True)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for part in ("TOOLS", "EXAMPLES", "TESTS", "BENCH"):
            toolchain.cache_variables[f"GCDT_{part}"] = False
        toolchain.cache_variables["GCDT_INSTALL"] = True
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        self.cpp_info.set_property("cmake_find_mode", "none")  # the library's own files for CMake are in the package
        self.cpp_info.builddirs.append(os.path.join("lib", "cmake", "gcdt"))
        self.cpp_info.libs = ["gcdt"]
        if self.options.shared:
            self.cpp_info.defines = ["GCDT_SHARED"]
        else:
            self.cpp_info.system_libs = ["OpenCL", "pthread", "stdc++", "m"]
