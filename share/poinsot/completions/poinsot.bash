# Completion of poinsot in bash: `source poinsot.bash`, or a copy named poinsot in ~/.local/share/bash-completion/completions.
# In zsh: autoload -U bashcompinit; bashcompinit; source poinsot.bash
# Commands, options and names are asked of the program itself, so they are those of the version that is installed.

_poinsot() {
   local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} words=
   COMPREPLY=()
   if [ "$COMP_CWORD" = 1 ]; then
      words="help $("$program" --help | sed -n 's/^   \([a-z]\{1,\}\)  .*/\1/p') --help --version"
   else
      case $before in
      --out) COMPREPLY=($(compgen -f -- "$word")); return ;;
      --methods) words=$(_poinsot_names methods) ;;
      --splittings) words=$(_poinsot_names splittings) ;;
      *)
         case $command in
         help) words=$("$program" --help | sed -n 's/^   \([a-z]\{1,\}\)  .*/\1/p') ;;
         run | view | cost | choose) words=$(_poinsot_names scenes); COMPREPLY=($(compgen -f -- "$word")) ;;
         scenes | effects | keys) words=$(_poinsot_names "$command") ;;
         reproduce) words="review hairer-vilmart fasso celledoni" ;;
         esac
         words="$words $("$program" "$command" --help | grep -o -e '--[a-z][a-z-]*' | sort -u)" ;;
      esac
   fi
   COMPREPLY+=($(compgen -W "$words" -- "$word"))
}

# First words of a list that the program prints.
_poinsot_names() {
   case $1 in
   keys) "${COMP_WORDS[0]}" keys | sed -n 's/^### `&\(.*\)`/\1/p' ;;
   *) "${COMP_WORDS[0]}" "$1" | awk 'NF == 0 && n { exit } /^[a-z]/ { print $1; n++ }' ;;
   esac
}

complete -o filenames -F _poinsot poinsot
