# Completion of zerorate for bash: commands, options, choices, models and files. It asks the program's own help, so that it
# knows what the installed version knows. Installed to /usr/share/bash-completion/completions/zerorate.

# The help of the command that the words so far name, in _zerorate_help.
_zerorate_read_help() {
  local program=$1 word within
  shift
  local path=()
  _zerorate_help=$("$program" --help 2>/dev/null)
  for word in "$@"; do
    [[ $word == -* ]] && continue
    within=$(_zerorate_commands)
    [[ " ${within//$'\n'/ } " == *" $word "* ]] || continue
    path+=("$word")
    _zerorate_help=$("$program" "${path[@]}" --help 2>/dev/null)
  done
}

_zerorate_commands() {
  sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p' <<<"$_zerorate_help"
}
_zerorate_options() {
  grep -E '^  -' <<<"$_zerorate_help" | sed 's/^  //; s/[ :=].*//' | tr ',' '\n' | grep -E '^--'
}
# The values of an option that has a list of them.
_zerorate_choices() {
  sed -n "s/^  \(-[a-z],\)\{0,1\}$1 [A-Z]*:{\([^}]*\)}.*/\2/p" <<<"$_zerorate_help" | tr ',' '\n'
}

_zerorate() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words choices
  COMPREPLY=()
  _zerorate_read_help "${COMP_WORDS[0]}" "${COMP_WORDS[@]:1:COMP_CWORD-1}"
  if [[ $current == -* ]]; then
    words=$(_zerorate_options)
  elif [[ $before == --model ]]; then
    words=$("${COMP_WORDS[0]}" model list 2>/dev/null | cut -d' ' -f1)
  elif [[ $before == --* ]] && choices=$(_zerorate_choices "$before") && [[ -n $choices ]]; then
    words=$choices
  elif [[ $before != -* ]]; then
    words=$(_zerorate_commands)
  fi
  # Nothing of these: bash offers files (-o default).
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}

complete -o default -F _zerorate zerorate
