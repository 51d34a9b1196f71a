# Failures of all engines and of naive methods in the situations where methods fail
#
# Run by `ballpiston figure stability --out DIR`, or by hand: sh stability.sh. It needs no server:
# the program `stability` counts the failures. With --full it takes about ten minutes on one core,
# else some seconds, with a small part of the starts.
set -eu
. ./figure.sh

# The program's progress is shown only if standard error is a terminal.
count() {
  quick=$(by_effort --quick --quick "")
  if [ -t 2 ]; then
    stability $quick
  elif ! stability $quick 2>".stability.$$"; then
    cat ".stability.$$" >&2
    return 1
  fi
}
into stability.md count

# The tables "All counts" of stability.md with the sum of all kinds of failures. Tabs separate the
# cells, because names contain commas. Only the first row of a block contains the case.
counts() {
  printf 'section\trow\tcase\tmethod\tstarts\tfailures\n'
  awk -F ' *[|] *' '
    BEGIN {
      kinds = "^(escapes|negative times|loops|still inward|missed|phantoms|pistons beyond)$"
    }
    /^<details>/ { section = $0; sub(/.*All counts: /, "", section); sub(/<.*/, "", section) }
    /^<\/details>/ { section = "" }
    section == "" || NF < 5 || /^[|]:?-/ { next }
    $2 == "case" {
      for (i = 2; i <= NF; ++i) {
        name[i] = $i
        if ($i == "starts") starts = i
      }
      next
    }
    {
      if ($2 != "") { ++row; situation = $2 }
      gsub(/,/, "", $starts)
      failures = 0
      for (i = starts + 1; i < NF; ++i) {
        if (name[i] ~ kinds) {
          gsub(/,/, "", $i)
          failures += $i
        }
      }
      printf "%s\t%d\t%s\t%s\t%s\t%d\n", section, row, situation, $3, $starts, failures
    }' stability.md
}
into stability.tsv counts

draw stability
