# Functions that the figures' scripts share; each script reads this file: . ./figure.sh

# The number of samples: "quick" takes seconds, "default" minutes, "full" has the paper's number of
# samples or more.
: "${effort:=default}"
case $effort in
  quick | default | full) ;;
  *)
    echo "effort: \"$effort\" is not one of quick, default, full" >&2
    exit 2
    ;;
esac

# Prints the argument for the effort: by_effort QUICK DEFAULT FULL.
by_effort() {
  case $effort in
    quick) echo "$1" ;;
    default) echo "$2" ;;
    full) echo "$3" ;;
  esac
}

# Runs a command and, if it succeeds, keeps its output in a file: into FILE COMMAND. The output
# first goes to a hidden file with a name of this shell alone, because the script of a killed client
# may still run in the same folder.
into() {
  file=$1
  part=.$1.$$
  shift
  "$@" >"$part"
  mv "$part" "$file"
}

# Asks, and keeps the answer in a CSV file that has its specification, seed and versions in its first
# lines: ask FILE EXPERIMENT FLAGS. If the same question was asked before, its job goes on.
ask() {
  asked=$1
  shift
  ballpiston run "$@" --resume --save "$asked" >/dev/null
}

trap 'rm -f .*."$$"' EXIT

# Draws the picture with NAME.gnuplot, if gnuplot is installed.
draw() {
  if command -v gnuplot >/dev/null; then
    gnuplot "$1.gnuplot"
    # gnuplot does not report a full disk.
    if [ -s "$1.svg" ] && ! tail -n 2 "$1.svg" | grep -q "</svg>"; then
      echo "$1.svg is not complete: the disk may be full" >&2
      exit 1
    fi
  else
    echo "gnuplot is not installed; to draw the figure later: gnuplot $1.gnuplot" >&2
  fi
}
