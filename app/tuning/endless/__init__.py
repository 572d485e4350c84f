"""Positions without end: the application note's service procedure (AN-001) for every axis that somebody watches."""

from app.tuning.endless.service import EndlessService as EndlessService
