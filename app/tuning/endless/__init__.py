"""Positions without end: the application note's service procedure (003) for every axis that somebody watches."""

from app.tuning.endless.service import EndlessService as EndlessService
