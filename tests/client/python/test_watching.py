"""Watches: through restarts of the server, interrupted, and what they show."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import termios
import threading
from typing import Any

import pytest
from conftest import ENDLESS, FIRST_HITS, LIMIT, Home, wait_until

import ballpiston
from ballpiston.errors import ResourceExhausted, Unavailable
from ballpiston.progress import Bar, Progress, _TqdmBar, has_terminal
from ballpiston.v1 import ensemble_pb2
from ballpiston.watch import Attachments, watch_job


JOB = "ensembleJobs/1"
CONNECT = f"ballpiston.connect(timeout={LIMIT})"


def streams(client: ballpiston.Client) -> float:
    """Watches and traces in progress."""
    return float(client.status().message.streams)


def test_a_watch_goes_on_after_the_server_was_killed(own_home: Home) -> None:
    with ballpiston.connect(timeout=LIMIT) as client, ballpiston.connect(timeout=LIMIT) as watching:
        job = client.submit(**ENDLESS)
        ends: list[BaseException] = []

        def watch() -> None:
            try:
                watching.job(job.name).watch(progress=False)
            except ballpiston.Error as error:
                ends.append(error)

        thread = threading.Thread(target=watch)
        thread.start()
        wait_until(lambda: job.state == "running" and streams(client) == 1)
        killed = own_home.server_id()
        own_home.end_server(signal.SIGKILL)
        wait_until(lambda: own_home.server_id() != killed and streams(client) == 1)
        assert ends == []
        job.cancel()
        thread.join(LIMIT)
        assert not thread.is_alive(), f"the watch has not ended after {LIMIT} seconds"
    assert [type(error) for error in ends] == [ballpiston.JobCancelled]


def test_ctrl_c_ends_the_watch_and_leaves_the_job(
    home: Home, client: ballpiston.Client, endless: ballpiston.Job
) -> None:
    program = (
        "import ballpiston, sys\n"
        f"client = {CONNECT}\n"
        "try: client.job(sys.argv[1]).watch()\n"
        "finally: print(client.status().state)"
    )
    watcher = home.python(program, endless.name)
    wait_until(lambda: streams(client) == 1)
    watcher.send_signal(signal.SIGINT)
    printed, message = watcher.communicate(timeout=LIMIT)
    assert printed == "serving\n" and watcher.returncode != 0 and "KeyboardInterrupt" in message
    assert f'The job goes on.\n  watch it again:  client.job("{endless.name}").watch()' in message
    assert not endless.has_ended
    wait_until(lambda: streams(client) == 0)


def test_the_main_thread_leaves_locks_to_others(
    client: ballpiston.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C would keep a lock of gRPC locked, and every later call of the client would hang."""
    users = []
    release = threading.Condition.__exit__

    def noted(lock: threading.Condition, *error: Any) -> None:
        if sys._getframe(1).f_code.co_name != "__del__":  # that of a call has nobody to wait for it
            users.append(threading.get_ident())
        release(lock, *error)

    monkeypatch.setattr(threading.Condition, "__exit__", noted)
    client.run(**FIRST_HITS, fresh=True, progress=False)
    next(client.trace(rho=0.5296, delta=0.1, events=1e4))
    monkeypatch.undo()
    assert users and threading.get_ident() not in users


def test_a_thread_watches_after_the_end_of_the_main_thread(home: Home) -> None:
    program = (
        "import ballpiston, threading\n"
        f"client = {CONNECT}\n"
        "def run():\n"
        "    threading.main_thread().join()\n"
        f"    print(client.run(**{ {**FIRST_HITS, 'fresh': True} }).state)\n"
        "threading.Thread(target=run).start()"
    )
    no_bar = ""  # because standard error is a pipe
    assert home.python(program).communicate(timeout=LIMIT) == ("succeeded\n", no_bar)


@pytest.mark.parametrize("hidden", ["", "tqdm"])
def test_a_terminal_shows_a_bar_unless_it_is_silenced(hidden: str, home: Home) -> None:
    program = (
        "import sys\n"
        f"if '{hidden}': sys.modules['{hidden}'] = None\n"
        "import ballpiston\n"
        f"{CONNECT}.run(**{ {**FIRST_HITS, 'fresh': True} }, progress=sys.argv[1] == 'bar')"
    )
    for progress, text in (("bar", "4/4 points"), ("silent", "")):
        here, there = os.openpty()
        process = home.python(program, progress, stdout=there, stderr=there)
        os.close(there)
        written = text_of(here)
        assert process.wait(LIMIT) == 0, written
        assert text in written and bool(text) == bool(written)


def text_of(terminal: int) -> str:
    """All that was written to the terminal, which is closed."""
    data = b""
    with contextlib.suppress(OSError):  # at the end
        while part := os.read(terminal, 4096):
            data += part
    os.close(terminal)
    return data.decode(errors="replace")


def test_a_bar_shows_points_an_estimate_and_lost_connections() -> None:
    progress: Any = Progress()
    lines: list[tuple[float, str]] = []
    progress.draw = lambda *line: lines.append(line)
    message: Any = ensemble_pb2.WatchEnsembleJobResponse()
    snapshot = message.snapshot
    snapshot.progress.points, snapshot.progress.points_done = 4, 1
    estimate = snapshot.points.add().estimates.add(name="mean_hit_time", value=57.663)
    estimate.standard_error = 0.123
    progress.show(message)
    progress.show(ensemble_pb2.WatchEnsembleJobResponse(heartbeat={}))
    progress.show_pause(False, 0.2)
    assert lines == [
        (0.25, "1/4 points  mean_hit_time 57.66 ± 0.12"),
        (0.25, "1/4 points  no answer, retrying in 0.2 s"),
    ]


def test_a_bar_is_shorter_than_a_line_of_the_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    bar = Bar()
    here, there = os.openpty()
    with open(there, "w") as terminal:
        monkeypatch.setattr("sys.stderr", terminal)
        for columns in (60, 30, 0):  # 0: unknown
            termios.tcsetwinsize(there, (24, columns))
            bar.draw(0.5, "4/4 points" + 80 * ".")
    assert [len(line) for line in text_of(here).split("\r")] == [0, 59, 29, 79]
    monkeypatch.setattr("sys.stderr", None)
    assert not has_terminal()


def test_the_time_left_does_not_count_the_time_in_the_queue(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tqdm = pytest.importorskip("tqdm").tqdm
    now = 0.0
    monkeypatch.setattr("tqdm.std.time", lambda: now)
    bar = _TqdmBar(tqdm)
    for now, fraction in ((0.0, 0.0), (1000.0, 0.0), (1010.0, 0.5)):
        bar.draw(fraction, "")
    assert "[00:10<00:10]" in capsys.readouterr().err


def test_pauses_double_until_the_server_is_heard() -> None:
    pace = Attachments(JOB, first=1, longest=4, give_up_after=1000)
    for expected in (1, 2, 4, 4):
        pause = pace.next_pause(now=0)
        assert pause is not None and expected <= pause <= 1.25 * expected
    pace.handle(update("", RUNNING))
    pause = pace.next_pause(now=10)
    assert pause is not None and pause <= 1.25
    pause = pace.next_pause(now=10, least=10)  # as the server asks
    assert pause is not None and 10 <= pause <= 12.5
    assert pace.next_pause(now=10, least=2000) is None


def test_a_watch_gives_up_after_the_configured_time() -> None:
    pace = Attachments(JOB, first=1, longest=4, give_up_after=10)
    for lost in (100, 200):  # the first time after a long sleep of this process
        assert pace.next_pause(now=lost) is not None
        assert pace.next_pause(now=lost + 5) is not None
        assert pace.next_pause(now=lost + 9.5) is None
        pace.handle(update("", RUNNING))


class ScriptedServer:
    """In place of a connection: each watch gets the next list of messages, then the stream ends."""

    def __init__(self, *streams: list[Any]) -> None:
        self.streams = list(streams)
        self.tokens: list[str] = []

    def stream(self, request: Any) -> Any:
        self.tokens.append(request.resume_token)
        return self.streams.pop(0) if self.streams else []

    def revive(self, wait: float) -> None:
        raise Unavailable("cannot be started")


def update(token: str, state: int) -> Any:
    return ensemble_pb2.WatchEnsembleJobResponse(resume_token=token, job={"state": state})


RUNNING, SUCCEEDED = ensemble_pb2.EnsembleJob.RUNNING, ensemble_pb2.EnsembleJob.SUCCEEDED


def test_a_watch_passes_the_last_resume_token_on() -> None:
    server: Any = ScriptedServer(
        [update("a", RUNNING), update("b", RUNNING)], [], [update("c", SUCCEEDED)]
    )
    at_once = Attachments(JOB, first=0, longest=0, give_up_after=LIMIT)
    job = watch_job(server, at_once, Progress())
    assert job.state == SUCCEEDED
    assert server.tokens == ["", "b", "b"]


def test_a_watch_that_gives_up_says_why() -> None:
    server: Any = ScriptedServer()
    hasty = Attachments(JOB, first=0.001, longest=0, give_up_after=0)
    with pytest.raises(Unavailable, match="gave up watching after 0 s.*ended the watch before"):
        watch_job(server, hasty, Progress())


def test_a_watch_waits_for_a_busy_server() -> None:
    busy = ResourceExhausted("too many", code="RESOURCE_EXHAUSTED", reason="TOO_MANY_STREAMS")
    assert Attachments(JOB).pause_after(busy) > 0
    hasty = Attachments(JOB, give_up_after=0)
    with pytest.raises(ResourceExhausted, match="too many"):
        hasty.pause_after(busy)


def test_an_error_ends_the_watch_and_the_message_says_how_to_watch_again(
    client: ballpiston.Client, endless: ballpiston.Job, monkeypatch: pytest.MonkeyPatch
) -> None:
    def expired(*_: Any) -> None:
        raise ballpiston.Unauthenticated("the token has expired")

    monkeypatch.setattr("ballpiston.job.watch_job", expired)
    with pytest.raises(ballpiston.Unauthenticated, match="expired\\nThe job goes on"):
        endless.watch()
    monkeypatch.setenv("BALLPISTON_CONFIG", "/dev/null")  # as in `ballpiston figure`
    with pytest.raises(ballpiston.Unauthenticated, match=f"ballpiston cancel {endless.name}$"):
        endless.watch()
    address = client.job(endless.name)._connection.address
    with ballpiston.connect(address, timeout=LIMIT) as named:
        with pytest.raises(ballpiston.Unauthenticated, match=f"{endless.name} --server {address}$"):
            named.job(endless.name).watch()
