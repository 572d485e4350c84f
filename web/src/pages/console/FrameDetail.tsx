import { ActionIcon } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { duration } from "../../lib/format";
import { Bytes } from "./Bytes";
import { bytesOf, replyFields, requestFields } from "./frames";
import { clock, type Frame } from "./log";

/** One frame of the log, byte by byte. */
export function FrameDetail({ frame, onClose }: { frame: Frame; onClose: () => void }) {
  const request = bytesOf(frame.tx);
  return (
    <section className="p-8 raised stack box gap-4 mt-8" aria-label="The chosen frame">
      <div className="lines-12 baseline">
        <b className="text-12 mono">{frame.text}</b>
        <span className="m-0 dim">
          <span className="num">{clock(frame.time_unix_s)}</span>, {frame.priority}, took{" "}
          <span className="num">{duration(frame.took_ms / 1000)}</span>
        </span>
        <ActionIcon size={20} ml="auto" aria-label="Close the frame" onClick={onClose}>
          <IconX size={13} />
        </ActionIcon>
      </div>
      {frame.error !== null && <p className="m-0 fault">{frame.error}</p>}
      <Bytes label="request" fields={requestFields(request)} />
      {frame.rx !== null && <Bytes label="reply" fields={replyFields(request, bytesOf(frame.rx))} />}
    </section>
  );
}
