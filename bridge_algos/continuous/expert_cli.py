"""``bridge-rl expert``: train experts, evaluate them, and let them demonstrate."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.expert_cards import EVALUATION_SEED
from bridge_algos.continuous.experts import SHIPPED
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError

_LEAST = (("threads", 1), ("episodes", 1), ("n", 1), ("iterations", 1), ("steps", 1), ("horizon", 1), ("seed", 0))
"""Least values of options."""
_UNREAD = {"ppo": ("steps",), "sb3": ("iterations", "horizon")}
"""Options of ``train`` that an algorithm does not take; sb3 trains on episodes as long as the environment allows."""


def parser() -> argparse.ArgumentParser:
    """The options of ``bridge-rl expert``."""
    p = Parser(prog="bridge-rl expert", description="Experts for Reacher and Ant (or another MuJoCo environment).")
    actions = p.add_subparsers(dest="action", required=True)
    train = actions.add_parser("train", help="train an expert and write its file and card; resumes when killed")
    train.add_argument("environment", help="reacher or ant")
    train.add_argument("--algorithm", choices=("ppo", "sb3"), default="ppo", help="ppo: batched, minutes; sb3: hours")
    train.add_argument("--iterations", type=int, help="of ppo (default: 300 for reacher, 1000 for ant)")
    train.add_argument("--steps", type=int, help="environment steps of sb3 (default 1,000,000)")
    train.add_argument("--seed", type=int, default=0, help="(default 0)")
    train.add_argument("--out", type=Path, help="the policy's .safetensors file (default out/expert-ENV.safetensors)")
    evaluate = actions.add_parser("evaluate", help="mean return of an expert over fresh episodes, with its error")
    demonstrate = actions.add_parser("demonstrate", help="write demonstrations as .npz or as a Minari dataset")
    for sub in (evaluate, demonstrate):
        sub.add_argument("environment", help="reacher, ant, or a Gymnasium id of a MuJoCo environment")
        shipped = ", ".join(SHIPPED)
        sub.add_argument(
            "--expert", help=f"a .safetensors file, an SB3 .zip, or one of {shipped} (default: the best shipped one)"
        )
        sub.add_argument("--sampled", action="store_true", help="draw actions instead of taking their means")
    evaluate.add_argument("--seed", type=int, default=EVALUATION_SEED, help="(default: that of the experts' cards)")
    demonstrate.add_argument("--seed", type=int, default=0, help="of initial states and actions (default 0)")
    evaluate.add_argument("--episodes", type=int, default=1000, help="(default 1000)")
    demonstrate.add_argument("--n", type=int, default=20, help="number of demonstrations (default 20)")
    demonstrate.add_argument("--out", required=True, help="FILE.npz, or the id of a new Minari dataset (name-v0)")
    for sub, whose in ((train, ", of ppo"), (evaluate, ""), (demonstrate, "")):
        sub.add_argument(
            "--horizon", type=int, help=f"steps of an episode{whose} (default: 50 for reacher, 100 for ant)"
        )
        sub.add_argument("--threads", type=int, help="(default: all cores); does not change the numbers")
    return p


def main(argv: list[str]) -> int:
    """Train, evaluate or demonstrate."""
    options = parser().parse_args(argv)
    for name, least in _LEAST:
        value = getattr(options, name, None)
        if value is not None and value < least:
            raise InputError(f"--{name} is {value}, expected at least {least}.")
    {"train": _train, "evaluate": _evaluate, "demonstrate": _demonstrate}[options.action](options, argv)
    return 0


def _train(options: argparse.Namespace, argv: Sequence[str]) -> None:
    from bridge_algos.continuous import ppo, sb3_training
    from bridge_algos.continuous.environments import make_environment
    from bridge_algos.continuous.expert_cards import describe
    from bridge_algos.continuous.policy_files import checked_path, save_policy

    environment = make_environment(options.environment)
    if environment.name not in ppo.PRESETS:
        raise InputError(f"there are no training settings for {environment.name!r}, expected {', '.join(ppo.PRESETS)}.")
    for name in _UNREAD[options.algorithm]:
        if getattr(options, name) is not None:
            raise InputError(f"--{name} is given, but {options.algorithm} does not take it; leave it out.")
    out = checked_path(options.out or Path("out") / f"expert-{environment.name}.safetensors")
    settings: dict[str, Any]
    if options.algorithm == "ppo":
        chosen = {name: getattr(options, name) for name in ("iterations", "horizon")}
        preset = replace(ppo.PRESETS[environment.name], **{k: v for k, v in chosen.items() if v is not None})
        settings = asdict(preset)
        checkpoint = out.with_suffix(".checkpoint.npz")
        policy = ppo.train(environment, preset, options.seed, checkpoint, options.threads)
    else:
        settings = {"steps": options.steps or sb3_training.STEPS}
        settings |= sb3_training.REACHER_PPO if environment.name == "reacher" else sb3_training.ANT_TD3
        settings["stable-baselines3"] = version("stable-baselines3")
        unfinished = {"environment": environment.gymnasium_id, "unfinished": True}
        policy = sb3_training.train_with_sb3(
            environment, options.seed, settings["steps"], lambda snapshot: save_policy(out, snapshot, unfinished)
        )
    command = shlex.join(["bridge-rl", "expert", *argv])
    how = (options.algorithm, settings, options.seed, command)
    card = describe(environment, policy, *how, horizon=options.horizon, threads=options.threads)
    save_policy(out, policy, card)
    print(f"{out}: {_sentence(card['evaluation'])}")


def _evaluate(options: argparse.Namespace, argv: Sequence[str]) -> None:
    from bridge_algos.continuous.environments import make_environment
    from bridge_algos.continuous.expert_cards import evaluation
    from bridge_algos.continuous.experts import load_expert

    environment = make_environment(options.environment)
    expert = load_expert(options.expert or environment.name, environment)
    result = evaluation(
        environment,
        expert,
        episodes=options.episodes,
        seed=options.seed,
        horizon=options.horizon,
        sampled=options.sampled,
        threads=options.threads,
        progress=sys.stderr.isatty(),
    )
    print(_sentence(result))


def _demonstrate(options: argparse.Namespace, argv: Sequence[str]) -> None:
    from bridge_algos.continuous.demonstrations import save_minari_demonstrations
    from bridge_algos.continuous.environments import draw_starts, make_environment
    from bridge_algos.continuous.episodes import save_episodes
    from bridge_algos.continuous.expert_cards import study_horizon
    from bridge_algos.continuous.experts import load_expert
    from bridge_algos.continuous.rollouts import rollout

    environment = make_environment(options.environment)
    expert = load_expert(options.expert or environment.name, environment)
    rng = np.random.default_rng(options.seed)
    starts = draw_starts(environment, options.n, rng)
    episodes = rollout(
        environment,
        expert,
        starts,
        horizon=options.horizon or study_horizon(environment),
        rng=rng if options.sampled else None,
        threads=options.threads,
    )
    if options.out.endswith(".npz"):
        save_episodes(options.out, episodes)
    else:
        save_minari_demonstrations(options.out, episodes, environment)
    print(f"{options.out}: {len(episodes)} demonstrations, mean return {episodes.returns.mean():.2f}")


def _sentence(result: dict[str, Any]) -> str:
    error = f" ± {1.96 * result['standard_error']:.2f} (95 %)" if result["episodes"] > 1 else ""
    return (
        f"mean return {result['return']:.2f}{error} over {result['episodes']} episodes of {result['horizon']} steps; "
        f"{result['terminated']} ended early"
    )
