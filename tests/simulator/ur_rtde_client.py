"""The real ur-rtde client in a process of its own: one JSON call a line in, one answer a line out.

It may crash and its constructors hold the interpreter's lock, so no test has it in its own process.
"""

import json
import sys
from typing import Any

import dashboard_client
import rtde_control
import rtde_receive


def open_interface(kind: str, address: str) -> Any:
    if kind == "control":
        return rtde_control.RTDEControlInterface(address)
    if kind == "upper_control":
        kind_of_control = rtde_control.RTDEControlInterface
        flags = int(kind_of_control.FLAG_UPLOAD_SCRIPT) | int(kind_of_control.FLAG_UPPER_RANGE_REGISTERS)
        return kind_of_control(address, -1.0, flags)
    if kind == "receive":
        return rtde_receive.RTDEReceiveInterface(address)
    dashboard = dashboard_client.DashboardClient(address)
    dashboard.connect()
    return dashboard


def plain(value: Any) -> Any:
    if isinstance(value, rtde_control.AsyncOperationStatus):
        return {
            "running": value.isAsyncOperationRunning(),
            "operation": value.operationId(),
            "changes": value.changeCount(),
            "progress": value.progress(),
        }
    return value


def main(address: str) -> None:
    interfaces: dict[str, Any] = {}
    for line in sys.stdin:
        kind, method, arguments = json.loads(line)
        try:
            if method == "open":
                interfaces[kind] = open_interface(kind, address)
                answer = {"value": None}
            else:
                answer = {"value": plain(getattr(interfaces[kind], method)(*arguments))}
        except RuntimeError as error:
            answer = {"error": str(error)}
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()


main(sys.argv[1])
