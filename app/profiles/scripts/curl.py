"""A profile as a shell program that needs curl alone."""

from __future__ import annotations

import json
from collections.abc import Iterator
from urllib.parse import quote

from .plan import Plan, meaning
from .preconditions import busy_of, target_of
from .text import lines, one_line

_HEAD = """\
#!/bin/sh
# Write a stepscope profile to a device with curl, through a running server, and check every read-back.
#
#   sh FILE [DEVICE]
#
# The server is STEPSCOPE_URL [default: http://127.0.0.1:8000]; one that asks for a token finds it in STEPSCOPE_TOKEN.
# Ends with 0 when the device holds the profile, 1 when it does not.
#
"""
_BODY = r"""
url=${STEPSCOPE_URL:-http://127.0.0.1:8000}
url=${url%/}
written=0
newline='
'

fail() {
    printf '%s; %s registers are written\n' "$1" "$written" >&2
    exit 1
}

# Secrets go to curl as lines of its settings: as arguments every user of this machine could read them.
session=$(od -An -N16 -tx1 /dev/urandom | tr -d ' \n')
settings() {
    printf 'header = "Stepscope-Session: %s"\n' "$session"
    if [ -n "${STEPSCOPE_TOKEN:-}" ]; then
        printf 'header = "Authorization: Bearer %s"\n' "$(printf '%s' "$STEPSCOPE_TOKEN" | sed 's/[\\"]/\\&/g')"
    fi
}

# ask METHOD PATH [BODY]: sets `answer`
ask() {
    answer=$(settings | curl --config - --silent --show-error --globoff --max-time 30 --request "$1" \
        --header 'Content-Type: application/json' ${3:+--data "$3"} --write-out '\n%{http_code}' \
        "$url/api/v1/$2") || fail "no answer from $url"
    code=${answer##*"$newline"}
    answer=${answer%"$newline"*}
    case $code in
    2??) ;;
    *) fail "$1 $2: status $code, $answer" ;;
    esac
}

# put REGISTER QUERY BODY
put() {
    ask PUT "devices/$device/registers/$1$2" "$3"
    case $answer in
    *'"verified":false'* | *'"verified": false'*) fail "$1$2 did not take $3: $answer" ;;
    esac
    written=$((written + 1))
    [ $((written % 50)) -ne 0 ] || ask PUT lease '{}' # we are still there
}

give_back() {
    settings | curl --config - --silent --output /dev/null --request DELETE "$url/api/v1/lease" || :
}

case $device in
'' | *[!a-z0-9-]*) fail "a device's id has small letters, digits and dashes" ;;
esac
command -v curl > /dev/null || fail "this needs curl"
ask POST lease "{\"name\":\"profile of a $model\"}" # nobody else writes meanwhile
trap give_back EXIT
trap 'exit 1' HUP INT TERM
ask GET "devices/$device"
case $answer in
*"\"model\":\"$model\""* | *"\"model\": \"$model\""*) ;;
*) fail "$device is no $model" ;;
esac

# number NAME: the whole number of that name in the answer
number() {
    printf '%s' "$answer" | sed -n 's/.*"'"$1"'": *\(-\{0,1\}[0-9][0-9]*\).*/\1/p'
}

# idle REGISTER QUERY NAME WHY: ends where the number of that name in the register is not 0
idle() {
    ask GET "devices/$device/registers/$1$2"
    [ "$(number "$3")" = 0 ] || fail "$4"
}

# No register that follows may give an axis somewhere to go: its target is where it stands.
axis=0
while [ "$axis" -lt "$axes" ]; do
    ask GET "devices/$device/axes/$axis"
    case $answer in
    *'"moving":false'* | *'"moving": false'*) ;;
    *) fail "axis $axis of $device moves: stop it first" ;;
    esac
    if [ -n "$target" ]; then
        put "$target" "?axis=$axis" "{\"value\":$(number position)}"
    elif [ "$(number target_position)" != "$(number position)" ]; then
        fail "axis $axis of $device stands, and not at its target: stop it first"
    fi
    axis=$((axis + 1))
done

"""
_END = """
printf '%s: %s registers written and checked\\n' "$device" "$written"
"""


def render(plan: Plan) -> str:
    """The whole file."""
    settings = [
        f"model={plan.model}",
        f"axes={plan.family.axes}",
        f"target={target_of(plan.model)}",
        f"device=${{1-{plan.device}}}",
    ]
    return _HEAD + "\n".join([*_about(plan), "", "set -eu", *settings]) + _BODY + "\n".join(_writes(plan)) + "\n" + _END


def _about(plan: Plan) -> Iterator[str]:
    yield f"# Profile: {one_line(plan.name)}"
    yield f"# {plan.about}"
    yield from (f"# {line}".rstrip() for line in (*lines(plan.note), *plan.left_out))


def _writes(plan: Plan) -> Iterator[str]:
    for busy in busy_of(plan.model):
        query = "" if busy.axis is None else f"?axis={busy.axis}"
        yield f"idle '{busy.register}' '{query}' '{busy.field or 'value'}' '{busy.why}'"
    for part in plan.parts:
        yield f"# {one_line(part.title)}"
        for write in part.writes:
            name = f"'{quote(write.register.name, safe='')}'"
            query = "''" if write.register.axis is None else f"'?axis={write.register.axis}'"
            body = {"fields": dict(write.fields)} if write.fields else {"value": write.value}
            call = f"put {name} {query} '{json.dumps(body, separators=(',', ':'))}'"
            said = one_line(meaning(write))
            yield call if write.fields or said == write.number else f"{call:<52} # {said}"
