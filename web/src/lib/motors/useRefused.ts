import { useState } from "react";

/** Which fields of a form have refused what stands in them: nothing may be kept with the values of before. */
export function useRefused() {
  const [refused, setRefused] = useState<readonly string[]>([]);
  const onWrong = (field: string) => (wrong: boolean) =>
    setRefused((now) => [...now.filter((each) => each !== field), ...(wrong ? [field] : [])]);
  return { any: refused.length > 0, onWrong };
}
