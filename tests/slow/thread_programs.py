"""Random programs of threads on walls: ``python tests/slow/thread_programs.py [--programs 1000] [--seed 1]``.

Each program is a process with two to five threads, most of them daemons, that share two walls and their arrays. A step
appends, reads, measures, interpolates, copies or saves a wall; one in a few comes from a place where it enters a call
again: the conversion of an argument, a signal, or a finalizer. Some programs write into the arrays meanwhile, fork in
the middle of calls (the child uses the walls), or end while daemons are in calls. A step may raise InputError and
nothing else; a program must end by itself within ``--seconds``. What fails is printed with its seed:
``--programs 1 --seed SEED`` runs it again.

``./develop sanitize [address | thread] --python`` runs them with a core that has sanitizers.
"""

from __future__ import annotations

import argparse
import faulthandler
import importlib.util
import os
import pickle
import random
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any


def load_core(path: Path) -> None:
    """Let `helibore` use the extension in a file instead of its own."""
    spec = importlib.util.spec_from_file_location("helibore._core", path)
    assert spec is not None
    assert spec.loader is not None
    sys.modules["helibore._core"] = core = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(core)


Step = Callable[[Any, random.Random], object]


class Program:
    """What the threads of a program share: walls, arrays, and the errors that must not be."""

    def __init__(self, seed: int, writes: bool, seconds: int, folder: Path) -> None:
        import numpy as np

        import helibore as hb

        self.np, self.hb, self.seconds, self.error = np, hb, seconds, hb.InputError
        self.ending, self.folder = sys.is_finalizing, folder
        self.random = random.Random(seed)
        self.writes = writes and self.random.random() < 0.5
        numbers = np.random.default_rng(seed)
        n = self.random.choice([50, 2_000, 40_000])
        self.columns = [numbers.uniform(100, 104, n), numbers.uniform(0, 360, n), numbers.normal(0.11, 1e-3, n)]
        kriging = {"estimator": "kriging", "kriging_range": 0.1}
        settings: list[dict[str, Any]] = [{}, {"sigma": True}, {"sectors": 16, "direct": True}, kriging]
        self.walls = [
            hb.Wall(bit_diameter=0.216, threads=self.random.choice([1, 2, 3]), **self.random.choice(settings))
            for _ in range(2)
        ]
        self.depth = threading.local()  # of calls within calls

    def step(self, chance: random.Random) -> None:
        """Do one step on a wall; an InputError is an answer."""
        inside = getattr(self.depth, "inside", 0)
        if inside > 3:
            return
        self.depth.inside = inside + 1
        try:
            chance.choice(self.steps())(self.walls[chance.randrange(2)], chance)
        except self.error:
            pass
        except (
            Exception
        ) as error:  # while Python ends, what a finalizer needs may be gone; 3.11 does not parse in a parse
            if not self.ending() and "AST constructor" not in str(error):
                raise
        finally:
            self.depth.inside = inside

    def steps(self) -> list[Step]:
        """Return what a thread may do."""
        steps: list[Step] = [self.append, self.append, self.append_again, self.read, self.measure, self.interpolate]
        steps += [self.copy, self.surface, self.rebuild, self.finalizer, self.set_images]
        return [*steps, self.write, self.write] if self.writes else steps

    def rows(self, chance: random.Random) -> list[Any]:
        """Return some rows of the arrays, without a copy."""
        first, count = chance.randrange(self.columns[0].size), chance.choice([1, 40, 3_000, 40_000])
        return [of[first : first + count] for of in self.columns]

    def append(self, wall: Any, chance: random.Random) -> None:
        """Append rows of the arrays."""
        wall.append(*self.rows(chance))

    def append_again(self, wall: Any, chance: random.Random) -> None:
        """Append rows whose conversion does another step."""
        program, rows = self, self.rows(chance)

        class Column:
            def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
                program.step(chance)
                return program.np.array(rows[2])

        wall.append(rows[0], rows[1], Column())

    def read(self, wall: Any, chance: random.Random) -> None:
        """Read columns of vertices and samples."""
        for name in chance.sample(["radius", "nearest", "support", "depth", "samples", "sigma", "settled"], 3):
            getattr(wall, name)
        wall.vertices(0, chance.randrange(400))
        wall.reach(0, chance.randrange(40))

    def measure(self, wall: Any, chance: random.Random) -> None:
        """Measure logs and zones."""
        if len(wall) < 100:
            return
        logs = wall.logs()
        chance.choice(
            [
                lambda: logs.coverage,
                lambda: logs.section,
                wall.zones,
                wall.summary,
                lambda: wall.measured,
                lambda: wall.drift(0.3),
            ]
        )()

    def interpolate(self, wall: Any, chance: random.Random) -> None:
        """Interpolate at the vertices and at other points."""
        if wall.sample_count:
            wall.interpolate_samples(wall.samples.radius)
            wall.at(*(of[:50] for of in self.rows(chance)[:2]))

    def copy(self, wall: Any, chance: random.Random) -> None:
        """Copy a wall by a pickle or an archive."""
        if chance.random() < 0.7 or wall.sample_count == 0:
            other = pickle.loads(pickle.dumps(wall))
        else:
            file = self.folder / f"{os.getpid()}-{threading.get_ident()}-{getattr(self.depth, 'inside', 0)}.wall"
            wall.save(file)
            other = self.hb.load(file)
            file.unlink()
        assert other.radius.size == len(other)

    def surface(self, wall: Any, _: random.Random) -> None:
        """Make a surface."""
        if len(wall) > 200:
            wall.surface()

    def rebuild(self, _: Any, chance: random.Random) -> None:
        """Rebuild a wall from the arrays, by an estimator that is found or stated."""
        estimator: Any = chance.choices(["inverse-distance", "kriging", "automatic"], [6, 6, 1])[0]
        rows = [of[: 200 if estimator == "automatic" else 4_000] for of in self.rows(chance)]
        self.hb.reconstruct(self.hb.Caliper(*rows), bit_diameter=0.216, estimator=estimator, stop_depth=102.0)

    def set_images(self, wall: Any, chance: random.Random) -> None:
        """Change what goes with a wall."""
        wall.made_from = {"seed": chance.random()}
        if quads := wall.surface().quads.shape[0] if 100 < len(wall) < 20_000 else 0:
            wall.attributes["A"] = self.np.zeros(quads)

    def write(self, _: Any, chance: random.Random) -> None:
        """Write into the arrays of all threads, also what is not finite."""
        column = self.columns[chance.randrange(3)]
        if chance.random() < 0.2:
            column[chance.randrange(column.size)] = chance.choice([float("nan"), float("inf"), -1.0, 1e300])
        else:
            column[:] = self.np.roll(column, chance.randrange(column.size))

    def finalizer(self, _: Any, chance: random.Random) -> None:
        """Leave garbage in a circle, whose finalizer does a step wherever it is collected."""
        program = self

        class Garbage:
            def __del__(self) -> None:
                program.step(chance)

        garbage = Garbage()
        garbage.__dict__["self"] = garbage

    def child(self, chance: random.Random) -> None:
        """Fork, use the walls in the child, and expect it to end well."""
        child = os.fork()
        if child == 0:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            faulthandler.register(signal.SIGALRM, chain=True)  # prints where it hangs, and ends it
            signal.alarm(self.seconds // 2)
            code = 9
            try:
                for _ in range(3):
                    self.step(chance)
                code = 0
            except BaseException:
                sys.excepthook(*sys.exc_info())
            os._exit(code)
        if code := os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]):
            raise AssertionError(f"the forked child ended with {code}")


def run(seed: int, writes: bool, forks: bool, seconds: int, folder: Path) -> None:
    """Run the program of a seed in this process, to its end."""
    program = Program(seed, writes, seconds, folder)
    chance = program.random
    ends = chance.choice(["joined", "daemons", "daemons", "exit", "exception"])
    failures: list[BaseException] = []

    def work(number: int, steps: int, forking: bool) -> None:
        own = random.Random(seed * 100 + number)
        try:
            for _ in range(steps):
                program.step(own)
                if forking and own.random() < 0.2:
                    program.child(own)
        except BaseException as error:
            failures.append(error)

    with_signals = chance.random() < 0.4
    if with_signals:  # Python runs the handler between any two of its own instructions in the main thread
        signals, left = random.Random(seed + 1), iter(range(20))

        def handler(*_: object) -> None:
            program.step(signals)
            if next(left, None) is not None:
                signal.setitimer(signal.ITIMER_REAL, 0.02)

        signal.signal(signal.SIGALRM, handler)
        signal.setitimer(signal.ITIMER_REAL, 0.02)
    threads = [
        threading.Thread(
            target=work, args=(number, chance.randrange(2, 9), forks and chance.random() < 0.3), daemon=True
        )
        for number in range(chance.randrange(1, 5))
    ]
    for thread in threads:
        thread.start()
    work(99, chance.randrange(2, 9), forks and chance.random() < 0.3)
    if ends == "joined" or failures:
        for thread in threads:
            thread.join()
    if with_signals:  # a handler that runs late sets the timer again, and Python ends without handlers
        signal.signal(signal.SIGALRM, signal.SIG_IGN)
    for error in failures:
        raise error
    if ends == "exit":
        sys.exit(7)
    if ends == "exception":
        sys.excepthook = lambda *_: None
        raise KeyboardInterrupt if chance.random() < 0.5 else ZeroDivisionError


def expected(status: int) -> bool:
    """Return whether a program may end with this status: by itself, as `run` chooses."""
    return (os.WIFEXITED(status) and os.WEXITSTATUS(status) in (0, 1, 7)) or status == signal.SIGINT


def main() -> int:
    """Run programs one after another, each in a child of this process, which has no threads."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--core", type=Path, help="the file of another helibore._core")
    parser.add_argument("--no-writes", action="store_true", help="no writes into arrays that a call reads: data races")
    parser.add_argument("--no-forks", action="store_true")
    parser.add_argument("--seconds", type=int, default=200, help="after which a program hangs")
    given = parser.parse_args()
    if given.core:
        load_core(given.core)
    import numpy.ma  # noqa: F401  # its first import, lazily and within a signal, never ends

    folder = Path(tempfile.mkdtemp())
    warm = Program(0, True, given.seconds, folder)
    import helibore.logs.passage
    import helibore.wall.automatic  # noqa: F401

    for step in warm.steps():  # imports what steps need: one that a signal interrupts is of no use to the signal
        step(warm.walls[0], warm.random)
    failed = 0
    for seed in range(given.seed, given.seed + given.programs):
        with tempfile.TemporaryFile() as output:
            child = os.fork()
            if child == 0:
                for stream in (1, 2):
                    os.dup2(output.fileno(), stream)
                faulthandler.enable()
                faulthandler.dump_traceback_later(given.seconds, exit=True)
                run(seed, not given.no_writes, not given.no_forks, given.seconds, folder)
                return 0
            status = os.waitpid(child, 0)[1]
            output.seek(0)
            text = output.read().decode(errors="replace")
        if not expected(status) or text:
            failed += 1
            print(f"program {seed}: status {status}\n{text[-3000:]}", flush=True)
        if seed % 50 == 0:
            print(f"{seed - given.seed + 1} programs, {failed} failed", flush=True)
    shutil.rmtree(folder)
    print(f"{given.programs} programs, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
