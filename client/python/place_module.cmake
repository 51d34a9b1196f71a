# Copies generated modules into the package: cmake -DFROM=BASE -DTO=BASE -DSUFFIXES=LIST -P ...
#
# The modules of google/rpc are part of the package, because the folder `google` belongs to other
# packages. So their imports are changed.
foreach(suffix IN LISTS SUFFIXES)
  file(READ ${FROM}${suffix} text)
  string(REPLACE "from google.rpc import" "from ballpiston._google_rpc import" text "${text}")
  file(WRITE ${TO}${suffix} "${text}")
endforeach()
