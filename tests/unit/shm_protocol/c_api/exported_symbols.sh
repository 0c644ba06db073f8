#!/usr/bin/env bash
# exported_symbols.sh LIBRARY HEADER: the library exports the functions that the header declares, and nothing else.
set -euo pipefail

exported=$(nm -D --defined-only "$1" | awk '{print $NF}' | sort)
declared=$(grep -E '^(int|uint32_t|uint64_t|void|const char\*) wade_[a-z_]+\(' "$2" | grep -oE 'wade_[a-z_]+\(' |
  tr -d '(' | sort)
[ -n "$declared" ]
diff <(echo "$declared") <(echo "$exported")
