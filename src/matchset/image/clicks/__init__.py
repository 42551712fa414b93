"""What a click may mean: `reading` weighs the discs that the network sees there and the region that grew in color."""
