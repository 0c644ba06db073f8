# bash completion for wade and its programs: subcommands, scenes and options, as --help has them.
_wade() {
  local word=${COMP_WORDS[COMP_CWORD]} command=("$1")
  if [ "${1##*/}" = wade ]; then
    if [ "$COMP_CWORD" -eq 1 ]; then
      mapfile -t COMPREPLY < <(compgen -W "$("$1" --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p')" -- "$word")
      return
    fi
    # Behind -- of `many` stand the options of a run.
    if [[ ${COMP_WORDS[1]} == many && " ${COMP_WORDS[*]:2:COMP_CWORD-2} " == *" -- "* ]]; then
      command+=(run)
    else
      command+=("${COMP_WORDS[1]}")
    fi
    if [[ $word != -* && ${COMP_WORDS[1]} =~ ^(run|many)$ ]]; then
      mapfile -t COMPREPLY < <(compgen -W "$("$1" scenes | cut -d' ' -f1)" -- "$word"; compgen -f -- "$word")
      return
    fi
  fi
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("${command[@]}" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]+')" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -F _wade wade fluid_server crowd_client shm_inspect shm_clean shm_record shm_replay
