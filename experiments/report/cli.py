"""``bridge-rl report``: a directory of runs and reproductions in, one page to look at out."""

from __future__ import annotations

from pathlib import Path

from bridge_algos.files import atomic_write_text
from bridge_algos.run.parallel import check_jobs
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError


def main(argv: list[str]) -> int:
    """Write the page and say where it is."""
    p = Parser(prog="bridge-rl report", description="Runs and reproductions as one self-contained HTML page.")
    p.add_argument("directory", type=Path, help="of a run, of a reproduction, or of several of them")
    p.add_argument("--out", type=Path, metavar="FILE", help="where to write the page (default DIRECTORY/report.html)")
    p.add_argument("--verify", type=int, default=3, metavar="N", help="logs of each run to verify (default 3)")
    p.add_argument("--check", choices=("quick", "full"), help="replay the evidence of the paper's statements first")
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the page")
    options = p.parse_args(argv)
    check_jobs(options.jobs)
    if options.verify < 1:
        raise InputError(f"--verify is {options.verify}, expected at least 1.")
    from experiments.report.found import find_items
    from experiments.report.page import page

    items = find_items(options.directory)
    path = options.out or options.directory / "report.html"
    atomic_write_text(
        path,
        page(items, options.directory.resolve().name, verify=options.verify, check=options.check, jobs=options.jobs),
    )
    print(f"report: {path} ({path.stat().st_size / 1e6:.1f} MB; needs no network)")
    return 0
