"""The marine drive in SciPy's solve_ivp, with the right-hand side of the numba program.

A right-hand side has no memory: the speed at touch is the floor of the law throughout, so the model
is a little another one, and its errors are relative to a reference of its own.
"""

import time

import numpy as np
from scipy.integrate import solve_ivp

import with_numba
from measure import EVERY, Result


def right_hand_side(drive):
    """Return f(t, y) with y = (q, v)."""
    m = with_numba.model(drive)
    memory = with_numba.memory(m)
    evaluate = with_numba.evaluate

    def function(_, y):
        size = len(y) // 2
        derivative = np.empty_like(y)
        derivative[:size] = y[size:]
        evaluate(m, memory, memory, True, y[:size], y[size:], derivative[size:])
        return derivative

    return function


def run(drive, method, tolerance, until, every=EVERY):
    """Simulate with one relative tolerance.

    The absolute tolerance is a thousandth of it in m and rad, and as much in m/s and rad/s.
    """
    function = right_hand_side(drive)
    q, v = with_numba.state(drive)
    size = len(q)
    start = np.concatenate([q, v])
    function(0.0, start)  # compiles
    absolute = np.concatenate([np.full(size, tolerance * 1e-3), np.full(size, tolerance)])
    times = np.arange(round(until / every) + 1) * every
    begin = time.process_time()
    solution = solve_ivp(
        function,
        (0.0, times[-1]),
        start,
        method=method,
        t_eval=times,
        rtol=tolerance,
        atol=absolute,
    )
    cpu = time.process_time() - begin
    if not solution.success:
        raise RuntimeError(solution.message)
    samples = solution.y.T.reshape(len(times), 2, size)
    tension = with_numba.tensions(drive, samples)
    # Steps are not reported; a step of RK45 costs six evaluations, one of DOP853 twelve.
    cost = {"RK45": 6, "DOP853": 12}.get(method, 1)
    return Result(tension, cpu, solution.nfev // cost, solution.nfev, until)
