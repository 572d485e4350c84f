"""Soft limits: what an axis may be asked for at most, enforced before anything leaves the server.

`axis_limits` is what the user sets. `limiter` judges what is about to go out, by what a write to a register or
parameter means on a chip as it is set (`core.limit_rules`, and `limits` in each family's folder). It is asked twice: by
the drivers when they know what they want, so that nothing of a move or a batch is sent, and by `LinkQueue` with every
frame, so that no path gets by. `watch` stops an axis before it leaves its range.

This file imports nothing, because connections (`devices.core.config`) need `axis_limits` before there are drivers.
"""
