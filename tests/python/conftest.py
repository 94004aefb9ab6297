"""Whoever starts the tests in the background has them ignore Ctrl-C, which their children inherit.

Some tests send it to a process of their own, and would wait for ever.
"""

import signal

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
