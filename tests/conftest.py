"""How every test runs: on the CPU, in strict 64-bit arithmetic, with run-time type checks, nothing random, no windows.

The environment is set before anything imports JAX or the package, which is why this happens on import.
"""

import gc
from collections.abc import Iterator
from typing import Any

import pytest
from browsers import CHROMIUM, FLAGS, Watched, served
from jax_settings import enter

enter()

# Traces of JAX are many objects that live long: to look through them as often as Python does costs a twelfth of all.
gc.set_threshold(100_000, 20, 20)

from beartype import BeartypeConf, beartype
from hypothesis import HealthCheck, settings
from jaxtyping import install_import_hook

# Checks every annotated argument and result of the package at run time. An int is a float, as for every type checker.
# The hook finds the checker by its dotted name, in this module.
checked = beartype(conf=BeartypeConf(is_pep484_tower=True))
install_import_hook("mckibben", f"{__name__}.checked")

# The same examples on every machine and every run; no deadline, because the first example may compile.
settings.register_profile(
    "mckibben", derandomize=True, deadline=None, database=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("mckibben")


# A page in a process of its own, and a tab of a browser before it.


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with served() as found:
        yield found


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    rules = ["--host-resolver-rules=MAP evil.example 127.0.0.1"]
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=[*FLAGS, *rules])
        yield made
        made.close()


@pytest.fixture
def seen(chromium: Any, address: str) -> Iterator[Watched]:
    context = chromium.new_context(viewport={"width": 1366, "height": 900})
    watched = Watched(context, address)
    yield watched
    watched.quiet()
    context.close()
