"""The interactive picture of a fit: every measured point with its test and numbers, and what is left."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.colors import to_hex

from mckibben.data.branches import UNKNOWN
from mckibben.results.fit import Fitted
from mckibben.spec.errors import SpecError
from mckibben.units import show
from mckibben.view import fit as still
from mckibben.view import style, web
from mckibben.view.measured import MARKERS

__all__ = ["fitted"]


def fitted(fit: Fitted) -> web.Web:
    """Measured forces over those of the fitted muscle, and the residuals below; a test is hidden in the legend."""
    if not len(fit.residuals):
        raise SpecError("interactive", allowed="the fit has no points")
    figure = web.panels(2, 1, shared_xaxes=True, row_heights=[0.6, 0.4], vertical_spacing=0.05)
    shown, (driver, _), told = still.columns(fit), still.drivers(fit), _texts(fit)
    for test, colour in still.colours_of(fit).items():
        of = still.of_test(fit, test)
        look = {"name": web.safe(test), "legendgroup": test}
        branches = fit.data["branch"].values[of]
        symbols = [web.SYMBOLS[MARKERS[str(branch)]] for branch in branches]
        points: dict[str, Any] = {"mode": "markers", "marker": {"color": to_hex(colour), "size": 7, "symbol": symbols}}
        texts = [told[k] for k in of.tolist()]
        figure.add_scatter(**web.dots(shown[driver][of], shown["force"][of], texts, **points, **look), row=1, col=1)
        for branch in dict.fromkeys(branches.tolist()):
            some = of[branches == branch]
            some = some[np.argsort(shown[driver][some], kind="stable")]
            line = {"mode": "lines", "line": {"color": to_hex(colour), "width": 1.5}, "showlegend": False}
            figure.add_scatter(
                **web.dots(shown[driver][some], shown["predicted"][some], None, **line, **look), row=1, col=1
            )
        left = web.dots(shown[driver][of], shown["residual"][of], texts, **points, **look, showlegend=False)
        figure.add_scatter(**left, row=2, col=1)
    figure.add_hline(0.0, line={"color": web.GREY, "width": 1}, row=2, col=1)
    figure.update_xaxes(title_text=still.label(driver), row=2, col=1)
    figure.update_yaxes(title_text=still.label("force"), row=1, col=1)
    figure.update_yaxes(title_text="Model less measured (N)", row=2, col=1)
    heading, notes = still.words(fit)
    return web.Web(figure, heading, ("Points: measured. Lines: model.", *notes, style.assumption(fit.muscle)), 600)


def _texts(fit: Fitted) -> list[str]:
    """What each measured point tells."""
    data, contractions, made = fit.data, still.columns(fit)["contraction"], []
    for k, (test, branch) in enumerate(zip(data["test"].values, data["branch"].values, strict=True)):
        numbers = (("length", "length", "m"), ("pressure", "pressure", "Pa"), ("measured", "force", "N"),
                   ("model", "predicted", "N"))  # fmt: skip
        lines = [(said, show(float(data[name].values[k]), unit, 5)) for said, name, unit in numbers]
        lines.insert(1, ("contraction", f"{contractions[k]:.5g} %"))
        lines.append(("model less measured", show(float(fit.residuals[k]), "N", 4)))
        made.append(web.hover(f"{test}, {branch}" if branch != UNKNOWN else str(test), lines))
    return made
