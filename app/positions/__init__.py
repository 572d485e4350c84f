"""Extended positions: the application note's service procedure (AN-001) for every axis that a user watches."""

from .service import ExtendedPositionService as ExtendedPositionService
