// What libraries that are not ours do not give back, for the leak sanitizer.
//
// libcares: a few bytes of a resolver's configuration, now and then, when gRPC looks up an address.
extern "C" const char* __lsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() { return "leak:libcares.so\n"; }
