"""States so near full extension that the direct search fails and the force is sought instead."""

import math

import numpy as np
import pytest

import mckibben as mk
from mckibben.experiment import Bench
from mckibben.solver.direct import find
from mckibben.solver.equilibrium import Held
from mckibben.stretched import stretched
