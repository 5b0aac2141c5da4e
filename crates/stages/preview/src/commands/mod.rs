//! What the binary does around the library: arguments, files, the order of work.

mod arguments;
mod draw;
mod shots;
mod tile;

pub(crate) use arguments::Arguments;
use arguments::Command;
use stage::Run;

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match (arguments.command, arguments.drawing) {
        (Some(Command::Tile(tile)), _) => tile::tile(run, &tile),
        (None, Some(drawing)) => draw::draw(run, &drawing),
        (None, None) => anyhow::bail!("there is nothing to draw\n  to do: give --mesh and --out"),
    }
}
