"""Run every mutant in a process of its own, and say what noticed it."""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

from tqdm import tqdm

from proofs_checks.mutation.graft import graft
from proofs_checks.mutation.killers import STAGES, Baseline, Killer, Stage, observe
from proofs_checks.mutation.sites import Site

_FORK = multiprocessing.get_context("fork")  # everything is imported once; each mutant gets a copy of that state
_PATIENCE = 10.0
"""A mutant may need this many times as long as the formulas as written before it counts as noticed (it hangs)."""

Task = TypeVar("Task")
Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Fate:
    """What became of one mutant: the killer that noticed it and how (``None``: it survived)."""

    site: Site
    killer: Killer | None
    how: str
    tried: int

    @property
    def stage(self) -> Stage | None:
        """Which kind of killer noticed it."""
        return self.killer.stage if self.killer else None


def observe_all(killers: Sequence[Killer], processes: int, longest: float = 60.0) -> list[Baseline]:
    """The baselines of all killers; those that take longer than ``longest`` seconds are left out."""
    pairs = _each(killers, observe, limit=longest, processes=processes, unit="check")
    return [baseline for _, baseline in pairs if baseline is not None]


def campaign(sites: Sequence[Site], baselines: Sequence[Baseline], processes: int) -> list[Fate]:
    """The fate of every site, in their order."""

    def order(baseline: Baseline) -> tuple[int, float]:
        return STAGES.index(baseline.killer.stage), baseline.seconds

    def try_all(site: Site) -> Fate:
        relevant = sorted((b for b in baselines if b.touches(site)), key=order)
        return _fate(site, relevant)

    longest = max((baseline.seconds for baseline in baselines), default=1.0)
    answers = dict(_each(sites, try_all, limit=60.0 + _PATIENCE * longest, processes=processes, unit="mutant"))
    return [
        fate if isinstance(fate := answers[site], Fate) else Fate(site, Killer("ledger", "time limit"), "hangs", 0)
        for site in sites
    ]


def _fate(site: Site, relevant: Sequence[Baseline]) -> Fate:
    try:
        graft(site)
    except Exception as error:
        return Fate(site, Killer("examples", site.module), f"cannot be imported: {error}", 0)
    for tried, baseline in enumerate(relevant, start=1):
        if not baseline.killer.passes():
            return Fate(site, baseline.killer, "fails", tried)
    return Fate(site, None, "", len(relevant))


def _each(
    tasks: Sequence[Task], work: Callable[[Task], Answer], *, limit: float, processes: int, unit: str
) -> Iterator[tuple[Task, Answer | None]]:
    """``work`` on every task, each in a forked process; ``None`` where one runs longer than ``limit`` or dies."""
    waiting = list(reversed(tasks))
    running: list[tuple[Connection, Task, Any, float]] = []
    with tqdm(total=len(tasks), unit=unit, disable=not sys.stderr.isatty(), leave=False) as bar:
        while waiting or running:
            while waiting and len(running) < processes:
                task = waiting.pop()
                receiver, sender = _FORK.Pipe(duplex=False)
                process = _FORK.Process(target=_send, args=(sender, work, task))
                process.start()
                sender.close()
                running.append((receiver, task, process, time.monotonic() + limit))
            ready = wait([receiver for receiver, *_ in running], timeout=1.0)
            for item in list(running):
                receiver, task, process, end = item
                if receiver not in ready and time.monotonic() <= end:
                    continue
                running.remove(item)
                answer = _receive(receiver) if receiver in ready else None
                if answer is None:
                    process.kill()
                process.join()
                bar.update()
                yield task, answer


def _send(sender: Connection, work: Callable[[Task], Answer], task: Task) -> None:
    sender.send(work(task))
    sender.close()


def _receive(receiver: Connection) -> Any:
    try:
        return receiver.recv()
    except EOFError:  # the process died
        return None
    finally:
        receiver.close()
