// Each program of the server begins with StartProcess. It replaces settings that the process may
// have inherited: closed standard files, the file mask, ignored signals.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ballpiston::server {

// Call it before files are opened, and before threads and child processes start.
inline void StartProcess() {
  // A file with the number of a closed standard file would receive the log. Standard output is
  // opened for reading: writing to it stays an error.
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(file, F_GETFD) >= 0) continue;
    open("/dev/null", file == STDOUT_FILENO ? O_RDONLY : O_RDWR);
  }
  umask(0077);               // only the server's user can use store and socket
  signal(SIGCHLD, SIG_DFL);  // where it is ignored, the exit status of a child is lost
  signal(SIGXFSZ, SIG_IGN);  // a file at its size limit is an error like a full disk
}

}  // namespace ballpiston::server
