// The fields of Mantine.
import { Select as MantineSelect, type SelectProps, TagsInput as MantineTagsInput, type TagsInputProps } from '@mantine/core'
import { Themed } from './Themed'

export const Select = (props: SelectProps) => (
  <Themed>
    <MantineSelect {...props} />
  </Themed>
)

export const TagsInput = (props: TagsInputProps) => (
  <Themed>
    <MantineTagsInput {...props} />
  </Themed>
)
