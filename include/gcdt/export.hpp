// SPDX-License-Identifier: Apache-2.0
// GCDT_API marks what the shared library exports; everything else is hidden.
#pragma once

#if defined(_WIN32) && defined(GCDT_SHARED)
#if defined(GCDT_BUILDING)
#define GCDT_API __declspec(dllexport)
#else
#define GCDT_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define GCDT_API __attribute__((visibility("default")))
#else
#define GCDT_API
#endif
