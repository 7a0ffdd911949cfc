/* SPDX-License-Identifier: Apache-2.0 */
/* The library from C, linked as pkg-config says. */
#include <gcdt/gcdt.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  char header[32];
  size_t devices = 0;
  sprintf(header, "%d.%d.%d", GCDT_VERSION_MAJOR, GCDT_VERSION_MINOR, GCDT_VERSION_PATCH);
  if (strcmp(header, gcdt_version()) != 0 || gcdt_device_count(&devices) != GCDT_OK) return 1;
  printf("gcdt %s, %u devices\n", gcdt_version(), (unsigned)devices);
  return devices > 0 ? 0 : 1;
}
