//! `mckibben completions`: scripts that let a shell complete commands, options and keys of scenario files.
//!
//! The scripts are those of `clap_complete`. Where a value begins with a key, as that of `--set KEY=VALUE`, they complete keys by
//! `mckibben keys --names`, so that they know the keys of the program that is installed. Checked by `tests/completions.rs`.

use crate::arguments::Arguments;
use crate::terminal;
use clap::{Arg, Command, CommandFactory as _};
use clap_complete::Shell;
use mckibben_run::failure::Failure;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Arguments of `mckibben completions`.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben completions bash > ~/.local/share/bash-completion/completions/mckibben
  mckibben completions zsh > ~/.zfunc/_mckibben
  mckibben completions fish > ~/.config/fish/completions/mckibben.fish

In these three shells keys of a scenario file are completed too, as in --set load.m and mckibben keys valve.")]
pub struct CompletionsArguments {
    /// The shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Completes keys in Bash, in place of `_mckibben` behind the options in place of `OPTIONS`. Bash splits words at `=`.
const BASH: &str = r#"
_mckibben_or_keys() {
    local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD-1]}" sign="=" path
    if [[ "$before" == "=" ]]; then
        before="${COMP_WORDS[COMP_CWORD-2]}"
    elif [[ ${COMP_CWORD} -eq 2 && "$before" == "keys" && "$word" != -* ]]; then
        before="--set"
        sign=""
    fi
    case "$before" in
        OPTIONS)
            COMPREPLY=()
            while IFS= read -r path; do
                [[ "$path" == *. ]] || path+="$sign"
                COMPREPLY+=("$path")
            done < <("$1" keys --names "$word" 2>/dev/null)
            compopt -o nospace 2>/dev/null
            ;;
        *)
            _mckibben "$@"
            ;;
    esac
}

complete -F _mckibben_or_keys -o bashdefault -o default mckibben
"#;

/// Completes keys in Zsh.
const ZSH: &str = r#"
_mckibben_keys() {
    local -a paths
    paths=(${(f)"$(mckibben keys --names "$PREFIX" 2>/dev/null)"})
    compadd -S '' -- ${(M)paths:#*.}
    compadd -S "$1" -- ${paths:#*.}
}

"#;

/// Completes keys in Fish.
const FISH: &str = r"
function __fish_mckibben_keys --argument-names sign
    for path in (mckibben keys --names (commandline -ct | string replace -r -- '^--?[a-z-]+=' '') 2>/dev/null)
        string match -q '*.' -- $path; and echo $path; or echo $path$sign
    end
end
";

/// Prints the script.
///
/// # Errors
/// [`Failure::output`] when it cannot be printed.
pub fn run(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    let mut command = Arguments::command();
    clap_complete::generate(arguments.shell, &mut command, "mckibben", &mut script);
    let script = String::from_utf8_lossy(&script);
    terminal::print(&match arguments.shell {
        Shell::Bash => script.into_owned() + &BASH.replace("OPTIONS", &options(&command).join("|")),
        Shell::Zsh => of_zsh(&script, &command),
        Shell::Fish => script.into_owned() + FISH + &of_fish(&command),
        _ => script.into_owned(),
    })
}

/// The arguments of a command whose values begin with a key.
fn with_keys(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|argument| value_name(argument).starts_with("KEY"))
}

fn value_name(argument: &Arg) -> &str {
    argument.get_value_names().and_then(|names| names.first()).map_or("", |name| name.as_str())
}

/// The options of any command whose values begin with a key.
fn options(command: &Command) -> Vec<String> {
    let mut options = BTreeSet::new();
    for argument in command.get_subcommands().flat_map(with_keys) {
        options.extend(argument.get_long().map(|name| format!("--{name}")));
        options.extend(argument.get_short().map(|name| format!("-{name}")));
    }
    options.into_iter().collect()
}

/// The script with keys in place of files.
fn of_zsh(script: &str, command: &Command) -> String {
    let names: BTreeSet<&str> = command.get_subcommands().flat_map(with_keys).map(value_name).collect();
    let with_options = names.iter().fold(script.to_owned(), |script, name| {
        script.replace(&format!(":{name}:_default"), &format!(":{name}: _mckibben_keys \"=\""))
    });
    let of_keys = |line: &str| match line.strip_prefix("'::path -- ") {
        Some(about) => format!("'::path -- {}", about.replace(":_default", ": _mckibben_keys \"\"")),
        None => line.to_owned(),
    };
    let mut lines: Vec<String> = with_options.lines().map(of_keys).collect();
    // Behind the line that says for which command the script is.
    lines.insert(1, ZSH.to_owned());
    lines.join("\n") + "\n"
}

/// Lines that add keys to the values of options, and to the argument of `keys`.
fn of_fish(command: &Command) -> String {
    let mut text = String::new();
    for inner in command.get_subcommands() {
        let condition = format!("__fish_mckibben_using_subcommand {}", inner.get_name());
        for argument in with_keys(inner) {
            let short = argument.get_short().map_or(String::new(), |name| format!(" -s {name}"));
            let long = argument.get_long().map_or(String::new(), |name| format!(" -l {name}"));
            // Writing to a string cannot fail, here and below.
            let _ = writeln!(
                text,
                "complete -c mckibben -n \"{condition}\"{short}{long} -x -a \"(__fish_mckibben_keys =)\""
            );
        }
        if inner.get_name() == "keys" {
            let _ = writeln!(text, "complete -c mckibben -n \"{condition}\" -f -a \"(__fish_mckibben_keys '')\"");
        }
    }
    text
}
