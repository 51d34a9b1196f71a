// Suppresses leaks of other projects' libraries for the leak sanitizer.
//
// libcares sometimes leaks a few bytes of a resolver's configuration when gRPC looks up an address.
extern "C" const char* __lsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() { return "leak:libcares.so\n"; }
