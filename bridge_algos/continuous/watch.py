"""``bridge-rl watch``: expert, clone and learned policies side by side, from the same initial states, animated."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.config import ContinuousConfig, continuous_preset, is_continuous
from bridge_algos.continuous.needs import need
from bridge_algos.envs.gymnasium_ids import mujoco_id
from bridge_algos.files import atomic_write
from bridge_theory.cli.options import Parser
from bridge_theory.errors import ComputationError, InputError

BACKENDS = ("egl", "osmesa", "glfw")
PATIENCE = 60.0
"""Seconds that a renderer has to draw one picture."""
PANEL = 240
CAPTION = 34
_CAMERAS = {"Reacher-v5": {"trackbodyid": 0, "distance": 0.62, "elevation": -90.0, "azimuth": 90.0}}
_PROBE = (
    "import mujoco; m = mujoco.MjModel.from_xml_string("
    '\'<mujoco><worldbody><light pos="0 0 2"/><geom size=".1"/></worldbody></mujoco>\'); d = mujoco.MjData(m); '
    "mujoco.mj_forward(m, d); r = mujoco.Renderer(m, 32, 32); r.update_scene(d); "
    "raise SystemExit(0 if r.render().max() > 0 else 1)"
)

Frames = list[tuple[NDArray[np.uint8], float]]
"""Images with the return so far."""


def main(argv: list[str]) -> int:
    """Render the policies of a run, or the expert and a clone where an environment is named."""
    p = Parser(prog="bridge-rl watch", description="Animate expert, clone and learned policies in MuJoCo.")
    p.add_argument("source", help="directory of a run, or reacher or ant for the expert and a clone")
    p.add_argument("--seed", type=int, default=0, help="which seed's policies (default 0)")
    p.add_argument("--episodes", type=int, default=3, help="how many initial states, the same for all (default 3)")
    p.add_argument("--out", type=Path, help="the animation, a .gif file (default SOURCE/watch.gif or SOURCE.gif)")
    options = p.parse_args(argv)
    for name, least in (("episodes", 1), ("seed", 0)):
        if getattr(options, name) < least:
            raise InputError(f"--{name} is {getattr(options, name)}, expected at least {least}.")
    directory = Path(options.source)
    config, greedy = _from_run(directory, options.seed) if directory.is_dir() else (_named(options.source), {})
    path = options.out or (directory / "watch.gif" if directory.is_dir() else Path(f"{options.source}.gif"))
    if path.suffix != ".gif":
        raise InputError(f"--out is {path}, expected a path that ends in .gif.")
    need("mujoco")
    backend = working_backend()
    if backend is None:
        raise ComputationError(
            f"MuJoCo can render off screen with none of {', '.join(_tried())} here (MUJOCO_GL chooses one); install a "
            "driver (Mesa's libegl1 for egl needs no graphics card) and try again."
        )
    os.environ["MUJOCO_GL"] = backend
    names, returns, frame_rate, panels = _play(config, options.seed, options.episodes, greedy)
    _write(path, names, panels, frame_rate)
    for name, own in zip(names, returns, strict=True):
        print(f"{name:<10} returns {', '.join(f'{value:.2f}' for value in own)}")
    print(f"\nanimation: {path}")
    return 0


def working_backend() -> str | None:
    """Which off-screen renderer works: the one that ``MUJOCO_GL`` names, or the first of ``BACKENDS``, if any.

    Each is tried in a process of its own, since a broken driver can end a process or never answer.
    """
    for backend in _tried():
        environment, command = {**os.environ, "MUJOCO_GL": backend}, [sys.executable, "-c", _PROBE]
        try:
            tried = subprocess.run(command, env=environment, capture_output=True, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            continue
        if tried.returncode == 0:
            return backend
    return None


def _tried() -> tuple[str, ...]:
    asked = os.environ.get("MUJOCO_GL")
    return (asked,) if asked else BACKENDS


def _named(source: str) -> ContinuousConfig:
    if not is_continuous(source):
        identifier = mujoco_id(source)
        hint = f" by that name, but {identifier} is one" if identifier else "; expected one of the two"
        raise InputError(f"{source!r} is no directory of a run and no MuJoCo environment{hint}.")
    return continuous_preset("published", source)


def _from_run(directory: Path, seed: int) -> tuple[ContinuousConfig, dict[str, int]]:
    """The configuration of a run and the candidate that each algorithm preferred in the end."""
    from bridge_algos.run.configuration import read_configuration
    from bridge_algos.run.store import load_run

    results = load_run(directory)
    config = read_configuration(results.attrs["configuration"])
    if not isinstance(config, ContinuousConfig):
        raise InputError(f"{directory} holds a run in {config.environment}, which has no pictures; expected MuJoCo.")
    if seed not in results.seed.values:
        raise InputError(f"{directory} holds no seed {seed}; it has {', '.join(map(str, results.seed.values))}.")
    last = results.greedy.sel(seed=seed).isel(round=-1)
    return config, {str(name): int(last.sel(algorithm=name)) for name in results.algorithm.values if name != "bc"}


def _play(
    config: ContinuousConfig, seed: int, episodes: int, greedy: dict[str, int]
) -> tuple[list[str], list[list[float]], float, list[list[Frames]]]:
    """Names, returns of each episode, frames a second, and frames of each episode, one list a policy."""
    from bridge_algos.continuous.environments import draw_starts
    from bridge_algos.continuous.features import cache_directory
    from bridge_algos.continuous.offline import candidates_of, demonstrations_and_clone
    from bridge_algos.continuous.rollouts import rollout
    from bridge_algos.run.plots import STYLES

    environment, expert, _, cloned = demonstrations_and_clone(config, seed, cache_directory())
    candidates = candidates_of(config, cloned, expert, seed)
    policies: dict[str, Any] = {"expert": expert, "BC": cloned.policy}
    policies |= {str(STYLES[name]["label"]): candidates[index] for name, index in greedy.items()}
    starts = draw_starts(environment, episodes, np.random.default_rng([seed, 1]))
    returns, panels = [], []
    render, frame_rate, close = _renderer(environment.gymnasium_id)
    for policy in policies.values():
        played = rollout(environment, policy, starts, horizon=config.horizon)
        returns.append(played.returns.tolist())
        panels.append(
            [render(int(start), played.actions[i, : played.lengths[i]]) for i, start in enumerate(starts.seeds)]
        )
    close()
    return list(policies), returns, frame_rate, panels


def _renderer(gymnasium_id: str) -> tuple[Callable[[int, Any], Frames], float, Callable[[], None]]:
    """What turns a seed of ``reset`` and actions into frames: the simulation, repeated, gives the same states."""
    import gymnasium

    camera = {"default_camera_config": _CAMERAS[gymnasium_id]} if gymnasium_id in _CAMERAS else {}
    shown = gymnasium.make(
        gymnasium_id, render_mode="rgb_array", width=PANEL, height=PANEL, disable_env_checker=True, **camera
    ).unwrapped

    def render(start: int, actions: Any) -> Frames:
        shown.reset(seed=start)
        total, frames = 0.0, [(np.asarray(shown.render()), 0.0)]
        for action in actions:
            total += float(shown.step(action)[1])
            frames.append((np.asarray(shown.render()), total))
        return frames

    return render, float(shown.metadata["render_fps"]), shown.close


def _write(path: Path, names: list[str], panels: list[list[Frames]], frame_rate: float) -> None:
    """All episodes one after another, policies side by side; one that has ended keeps its last picture."""
    from PIL import Image, ImageDraw, ImageFont

    font = ImageFont.load_default(13)
    pictures = []
    for episode in range(len(panels[0])):
        steps = max(len(own[episode]) for own in panels)
        for step in range(steps):
            picture = Image.new("RGB", (PANEL * len(names), PANEL + CAPTION), "white")
            draw = ImageDraw.Draw(picture)
            for column, (name, own) in enumerate(zip(names, panels, strict=True)):
                image, total = own[episode][min(step, len(own[episode]) - 1)]
                picture.paste(Image.fromarray(image), (PANEL * column, CAPTION))
                ended = ", ended" if step >= len(own[episode]) and len(own[episode]) < steps else ""
                draw.text((PANEL * column + 8, 1), f"{name}{ended}", fill="black", font=font)
                draw.text((PANEL * column + 8, 16), f"return so far {total:.2f}", fill="#444444", font=font)
            pictures.append(picture)
    buffer = io.BytesIO()
    duration = max(20, round(2000 / frame_rate))  # half speed; viewers slow down what is faster than 20 ms
    pictures[0].save(buffer, "GIF", save_all=True, append_images=pictures[1:], duration=duration, loop=0)
    with atomic_write(path) as handle:
        handle.write(buffer.getvalue())
