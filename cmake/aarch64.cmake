# AArch64 with Debian's cross compiler. qemu-user runs the tests. Debian's packages for arm64 lie
# beside this machine's own (multiarch), so neither needs a folder to look into.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64)
