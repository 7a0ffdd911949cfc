// SPDX-License-Identifier: Apache-2.0
// Stands between a program and the C library (linked into it, or by LD_PRELOAD): one of the calls that change files
// fails, or is the process's last. Reads the environment at each call:
//   GCDT_FILES         the folder, an absolute path without links, below which calls count
//   GCDT_FILE_CALL     the number of the call, from 1 on; where it is another than before, counting begins anew
//   GCDT_FILE_FAULT    fail: it fails with ENOSPC, a write after half of its bytes, a close when half of the file is lost
//                      full: so do it and all after it that need room on the disk, as where the disk is full
//                      kill: the process is killed there, in a write when half of its bytes are written
//   GCDT_FILE_RENAMES  set: only calls that rename count
//   GCDT_FILE_MARK     a file, made when that call is reached
//   GCDT_FILE_NAMED    no file can be made without a name, as on some file systems
// Calls that remove files are counted and can be the last, but never fail: then something must be left behind.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum Kind { CREATES, WRITES, CLOSES, LINKS, RENAMES, SETS, REMOVES };
enum Fault { NONE, FAIL, KILL };

// That of the C library, or of the next one in between.
#define NEXT(type, name) ((type)next_function(#name))
static void* next_function(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  if (!found) abort();
  return found;
}

static int is_below(const char* path) {
  const char* const folder = getenv("GCDT_FILES");
  if (!folder || !path) return 0;
  char whole[2 * PATH_MAX];
  if (path[0] != '/') {
    if (!getcwd(whole, PATH_MAX)) return 0;
    const size_t length = strlen(whole);
    snprintf(whole + length, sizeof whole - length, "/%s", path);
    path = whole;
  }
  const size_t length = strlen(folder);
  return strncmp(path, folder, length) == 0 && path[length] == '/';
}

static int is_below_of(int descriptor) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0 || path[0] != '/') return 0;  // a pipe or a socket
  path[length] = 0;
  return is_below(path);
}

// Of the call that is made now, which changes something in the folder.
static enum Fault fault_of(enum Kind kind) {
  static atomic_uint calls, last_wanted;
  const char* const number = getenv("GCDT_FILE_CALL");
  const char* const fault = getenv("GCDT_FILE_FAULT");
  if (!number || !fault) return NONE;
  if (kind != RENAMES && getenv("GCDT_FILE_RENAMES")) return NONE;
  const int kills = strcmp(fault, "kill") == 0, full = strcmp(fault, "full") == 0;
  if (!kills && kind == REMOVES) return NONE;
  if (full && (kind == RENAMES || kind == SETS)) return NONE;
  const unsigned wanted = (unsigned)strtoul(number, NULL, 10);
  if (atomic_exchange(&last_wanted, wanted) != wanted) calls = 0;
  const unsigned call = atomic_fetch_add(&calls, 1) + 1;
  if (call < wanted || (call > wanted && !full)) return NONE;
  const char* const mark = getenv("GCDT_FILE_MARK");
  if (mark) {
    const long descriptor = syscall(SYS_openat, AT_FDCWD, mark, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    if (descriptor >= 0) syscall(SYS_close, (int)descriptor);
  }
  if (kills && kind != WRITES) kill(getpid(), SIGKILL);
  return kills ? KILL : FAIL;
}

static int refused(enum Kind kind, int below) {
  if (!below || fault_of(kind) == NONE) return 0;
  errno = ENOSPC;
  return 1;
}

static int changes(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0; }

// Where a file is made that was not there, or one is to be written.
#define GCDT_OPEN(name)                                                                             \
  int name(const char* path, int flags, ...) {                                                      \
    va_list rest;                                                                                   \
    va_start(rest, flags);                                                                          \
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;            \
    va_end(rest);                                                                                   \
    if ((flags & O_TMPFILE) == O_TMPFILE && is_below(path) && getenv("GCDT_FILE_NAMED")) {          \
      errno = EOPNOTSUPP;                                                                           \
      return -1;                                                                                    \
    }                                                                                               \
    if (changes(flags) && refused(CREATES, is_below(path))) return -1;                              \
    return NEXT(int (*)(const char*, int, ...), name)(path, flags, mode);                           \
  }
GCDT_OPEN(open)
GCDT_OPEN(open64)

#define GCDT_FOPEN(name)                                                                            \
  FILE* name(const char* path, const char* mode) {                                                  \
    const int changed = strpbrk(mode, "wa+") != NULL;                                               \
    if (changed && refused(CREATES, is_below(path))) return NULL;                                   \
    return NEXT(FILE * (*)(const char*, const char*), name)(path, mode);                            \
  }
GCDT_FOPEN(fopen)
GCDT_FOPEN(fopen64)

int mkstemp(char* name) {
  if (refused(CREATES, is_below(name))) return -1;
  return NEXT(int (*)(char*), mkstemp)(name);
}
int mkdir(const char* path, mode_t mode) {
  if (refused(CREATES, is_below(path))) return -1;
  return NEXT(int (*)(const char*, mode_t), mkdir)(path, mode);
}

// Of descriptors: something was written since they were opened.
static atomic_uchar is_written[1024];
static void wrote(int descriptor) {
  if (descriptor >= 0 && descriptor < 1024) is_written[descriptor] = 1;
}
static int was_written(int descriptor) {
  return descriptor >= 0 && descriptor < 1024 && atomic_exchange(&is_written[descriptor], 0);
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  size_t (*const next)(const void*, size_t, size_t, FILE*) =
      NEXT(size_t(*)(const void*, size_t, size_t, FILE*), fwrite);
  wrote(fileno(file));
  const enum Fault fault = is_below_of(fileno(file)) ? fault_of(WRITES) : NONE;
  if (fault == NONE) return next(bytes, size, count, file);
  const size_t done = next(bytes, size, count / 2, file);
  fflush(file);
  if (fault == KILL) kill(getpid(), SIGKILL);
  errno = ENOSPC;
  return done;
}
ssize_t write(int descriptor, const void* bytes, size_t size) {
  wrote(descriptor);
  const enum Fault fault = is_below_of(descriptor) ? fault_of(WRITES) : NONE;
  if (fault == NONE) return syscall(SYS_write, descriptor, bytes, size);
  syscall(SYS_write, descriptor, bytes, size / 2);
  if (fault == KILL) kill(getpid(), SIGKILL);
  errno = ENOSPC;
  return -1;
}
ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  wrote(descriptor);
  const enum Fault fault = is_below_of(descriptor) ? fault_of(WRITES) : NONE;
  if (fault == NONE) return syscall(SYS_writev, descriptor, parts, count);
  if (count > 0) syscall(SYS_write, descriptor, parts[0].iov_base, parts[0].iov_len / 2);
  if (fault == KILL) kill(getpid(), SIGKILL);
  errno = ENOSPC;
  return -1;
}

// What was still to be written is not.
static void lose_half(int descriptor) {
  struct stat known;
  if (was_written(descriptor) && fstat(descriptor, &known) == 0 && ftruncate(descriptor, known.st_size / 2) != 0) abort();
}
static int writable(int descriptor) {
  const int flags = fcntl(descriptor, F_GETFL);
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}
int fclose(FILE* file) {
  int (*const next)(FILE*) = NEXT(int (*)(FILE*), fclose);
  const int descriptor = fileno(file);
  if (!writable(descriptor) || !refused(CLOSES, is_below_of(descriptor))) {
    was_written(descriptor);
    return next(file);
  }
  fflush(file);
  lose_half(descriptor);
  next(file);
  errno = ENOSPC;
  return EOF;
}
int close(int descriptor) {
  if (!writable(descriptor) || !refused(CLOSES, is_below_of(descriptor))) {
    was_written(descriptor);
    return (int)syscall(SYS_close, descriptor);
  }
  lose_half(descriptor);
  syscall(SYS_close, descriptor);
  errno = ENOSPC;
  return -1;
}

int rename(const char* from, const char* to) {
  if (refused(RENAMES, is_below(to))) return -1;
  return NEXT(int (*)(const char*, const char*), rename)(from, to);
}
int link(const char* from, const char* to) {
  if (refused(LINKS, is_below(to))) return -1;
  return NEXT(int (*)(const char*, const char*), link)(from, to);
}
int chmod(const char* path, mode_t mode) {
  if (refused(SETS, is_below(path))) return -1;
  return NEXT(int (*)(const char*, mode_t), chmod)(path, mode);
}
int fchmodat(int folder, const char* path, mode_t mode, int flags) {
  if (refused(SETS, is_below(path))) return -1;
  return NEXT(int (*)(int, const char*, mode_t, int), fchmodat)(folder, path, mode, flags);
}

#define GCDT_REMOVE(name)                                   \
  int name(const char* path) {                              \
    if (is_below(path)) fault_of(REMOVES);                  \
    return NEXT(int (*)(const char*), name)(path);          \
  }
GCDT_REMOVE(remove)
GCDT_REMOVE(unlink)
GCDT_REMOVE(rmdir)
int unlinkat(int folder, const char* path, int flags) {
  if (folder == AT_FDCWD ? is_below(path) : is_below_of(folder)) fault_of(REMOVES);
  return NEXT(int (*)(int, const char*, int), unlinkat)(folder, path, flags);
}
