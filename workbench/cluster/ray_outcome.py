"""How a task of Ray ended: with its result, with an error of its own, or because something died."""

from __future__ import annotations

from typing import Any

from workbench.cluster.ray_connection import ClusterError
from workbench.cluster.run_agent import Outcome


def outcome_of(reference: Any) -> tuple[Outcome | None, str]:
    """How a task ended on its node, and in words if it died."""
    import ray
    from ray.exceptions import RayError, RayTaskError

    try:
        outcome: Outcome = ray.get(reference)
    except RayTaskError as error:
        return None, f"its node could not go on ({error.cause})"
    except RayError as error:
        return None, f"its worker or its node died ({type(error).__name__})"
    code = outcome.exit_code
    return outcome, f"its process died ({f'signal {-code}' if code is not None and code < 0 else f'exit code {code}'})"


def result_of(reference: Any) -> Any:
    """A task's result.

    Raises:
        ClusterError: its nodes died, more often than it may begin again.
    """
    import ray
    from ray.exceptions import RayError, RayTaskError

    try:
        return ray.get(reference)
    except RayTaskError:
        raise
    except RayError as error:
        raise ClusterError(f"a task's worker or node died too often ({type(error).__name__})") from error
