//! `calipose completions` and `man`.

use std::path::Path;

use clap_complete::Shell;
use clap_mangen::Man;

use crate::cli::Arguments;
use crate::cli::interrupt::writing;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::plan::results::write_atomically;

pub(crate) fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::commands(), "calipose", &mut script);
    Screen::print(String::from_utf8_lossy(&script).trim_end())
}

pub(crate) fn manual(folder: Option<&Path>, screen: &mut Screen) -> Result<(), Failure> {
    let mut command = Arguments::commands();
    let Some(folder) = folder else { return Screen::print(page(command)?.1.trim_end()) };
    // Subcommands get their full names, `calipose plan`, and what they share with the others.
    command.build();
    let commands = command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help").cloned();
    let pages = std::iter::once(command.clone()).chain(commands).map(page).collect::<Result<Vec<_>, Failure>>()?;
    writing(|| pages.iter().try_for_each(|(name, text)| write_atomically(&folder.join(name), text.as_bytes())))?;
    screen.text(&format!("Wrote {1} manual pages to {0}.", folder.display(), pages.len()))
}

/// File name and text of a command's manual page.
fn page(command: clap::Command) -> Result<(String, String), Failure> {
    let page = Man::new(command);
    let mut text = Vec::new();
    page.render(&mut text)?;
    Ok((page.get_filename(), String::from_utf8_lossy(&text).into_owned()))
}
