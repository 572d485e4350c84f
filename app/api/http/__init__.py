"""What every request passes before a route, and what it may get instead of an answer: access, roles, lease, errors."""
